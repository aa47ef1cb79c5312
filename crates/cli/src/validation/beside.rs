//! Pages of comparisons with other programs, as parts of the page.

use crate::failure::Failure;
use std::path::{Component, Path, PathBuf};

/// A page as a part: its headings a step lower, its links from the folder of the page that takes it in. `page` has to lie below
/// that folder.
pub fn part(page: &Path, out: &Path) -> Result<String, Failure> {
    let failed = |text: String| Failure::Input(format!("{}: {text}", page.display()));
    let text = std::fs::read_to_string(page).map_err(|error| failed(format!("cannot be read: {error}")))?;
    let folder = |path: &Path| path.parent().map(Path::to_path_buf).unwrap_or_default();
    let below = folder(page);
    let below = below.strip_prefix(folder(out)).map_err(|_| {
        failed(format!(
            "found outside of the folder of {}, expected within it: its links would break",
            out.display()
        ))
    })?;
    let mut fenced = false;
    let lines = text.lines().map(|line| {
        fenced ^= line.starts_with("```");
        if fenced {
            return format!("{line}\n");
        }
        let lower = if line.starts_with('#') { "#" } else { "" };
        format!("{lower}{}\n", with_links(line, below))
    });
    Ok(lines.collect())
}

/// A line with its relative links told from the folder in which `below` is.
fn with_links(line: &str, below: &Path) -> String {
    const LINK: &str = "](";
    let mut parts = line.split(LINK);
    let mut told = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(')').unwrap_or(part.len());
        let (target, rest) = part.split_at(end);
        let elsewhere = target.contains("://") || target.starts_with(['#', '/']);
        let target = if elsewhere { target.to_owned() } else { normal(&below.join(target)) };
        told.push_str(LINK);
        told.push_str(&target);
        told.push_str(rest);
    }
    told
}

/// A path without steps down that it takes back, as links write it.
fn normal(path: &Path) -> String {
    let mut all = PathBuf::new();
    for component in path.components() {
        let down = matches!(all.components().next_back(), Some(Component::Normal(_)));
        match component {
            Component::ParentDir if down => {
                all.pop();
            }
            Component::CurDir => {}
            _ => all.push(component),
        }
    }
    all.components().map(|one| one.as_os_str().to_string_lossy().into_owned()).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_taken_in_with_lower_headings_and_links_that_hold() {
        let folder = tempfile::tempdir().unwrap();
        let page = folder.path().join("evidence/one.md");
        std::fs::create_dir(page.parent().unwrap()).unwrap();
        let text = "# One\nSee [it](../../benches/it.py#L3), [her](her.md) and [them](https://example.org/a).\n```sh\n# not this\n```\n## Two\n";
        std::fs::write(&page, text).unwrap();
        let told = part(&page, &folder.path().join("page.md")).unwrap();
        let expected = "## One\nSee [it](../benches/it.py#L3), [her](evidence/her.md) and [them](https://example.org/a).\n```sh\n# not this\n```\n### Two\n";
        assert_eq!(told, expected);
    }

    #[test]
    fn a_page_that_is_not_there_or_lies_elsewhere_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let page = folder.path().join("one.md");
        let refused = |out: &str| part(&page, &folder.path().join(out)).unwrap_err().to_string();
        assert!(refused("page.md").contains("one.md: cannot be read"));
        std::fs::write(&page, "# One\n").unwrap();
        assert!(refused("docs/page.md").contains("expected within it"));
    }
}
