//! Tables of pages of evidence that tests make.
//!
//! A table stands between `<!-- NAME -->` and `<!-- end -->`; `HEADLAND_WRITE=1 cargo test --test whole` writes them anew.

use crate::root;
use std::sync::Mutex;

/// Tests that run side by side write one page.
static WRITING: Mutex<()> = Mutex::new(());

/// Holds that a page of evidence has this table under a name.
pub fn holds(page: &str, name: &str, table: &str) {
    let _writing = WRITING.lock().unwrap();
    let path = root().join("docs/evidence").join(page);
    let text = std::fs::read_to_string(&path).unwrap();
    let (begin, end) = (format!("<!-- {name} -->\n"), "<!-- end -->");
    let from = text.find(&begin).unwrap_or_else(|| panic!("{page} has no table {name}")) + begin.len();
    let to = from + text[from..].find(end).unwrap_or_else(|| panic!("the table {name} of {page} has no end"));
    if std::env::var_os("HEADLAND_WRITE").is_some() {
        std::fs::write(&path, format!("{}{table}{}", &text[..from], &text[to..])).unwrap();
        return;
    }
    assert!(
        text[from..to] == *table,
        "the table {name} of docs/evidence/{page} differs from what is computed; `HEADLAND_WRITE=1 cargo test --test whole` \
         writes it anew\n{table}"
    );
}
