//! The page: markup, style, data and the script that draws.

use crate::{Item, Plot, Report, ReportError, Section};
use serde_json::{Value, json};
use std::fmt::Write;

const ECHARTS: &str = include_str!("../assets/echarts.min.js");
const SCRIPT: &str = include_str!("../assets/report.js");
const STYLE: &str = include_str!("../assets/report.css");

/// Forbids the page to fetch anything.
const POLICY: &str =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:";

/// Text as it may stand in markup and between double quotes.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            character => escaped.push(character),
        }
    }
    escaped
}

/// JSON as it may stand in a script element, which ends at the first `</script`, and is confused by `<!--`.
fn embed(value: &Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

pub(crate) fn page(report: &Report) -> Result<String, ReportError> {
    let title = escape(&report.title);
    let mut specs = Vec::new();
    let mut body = format!("<header><h1>{title}</h1>");
    if !report.lede.is_empty() {
        let _ = write!(body, "<p class=\"lede\">{}</p>", escape(&report.lede));
    }
    body.push_str("</header>\n");
    body.push_str(&contents(&report.sections));
    body.push_str("<main>\n");
    for (number, section) in report.sections.iter().enumerate() {
        body.push_str(&part(section, number, &mut specs)?);
    }
    body.push_str("</main>\n");
    let data = embed(&Value::Array(specs));
    Ok(format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{title}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}\
         <footer>Plots: Apache ECharts, Apache License 2.0.</footer>\n\
         <noscript><p>The plots need JavaScript; words and tables do not.</p></noscript>\n\
         <script type=\"application/json\" id=\"plots\">{data}</script>\n\
         <script>{ECHARTS}</script>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n"
    ))
}

fn contents(sections: &[Section]) -> String {
    if sections.len() < 2 {
        return String::new();
    }
    let mut html = "<nav aria-label=\"Contents\"><ol>".to_owned();
    for (number, section) in sections.iter().enumerate() {
        let _ = write!(html, "<li><a href=\"#s{number}\">{}</a></li>", escape(&section.title));
    }
    html.push_str("</ol></nav>\n");
    html
}

fn part(section: &Section, number: usize, specs: &mut Vec<Value>) -> Result<String, ReportError> {
    let mut html = format!(
        "<section id=\"s{number}\" aria-labelledby=\"h{number}\"><h2 id=\"h{number}\">{}</h2>\n",
        escape(&section.title)
    );
    if !section.words.is_empty() {
        let _ = writeln!(html, "<p>{}</p>", escape(&section.words));
    }
    for item in &section.items {
        match item {
            Item::Plot(plot) => html.push_str(&figure(plot, section, number, specs)?),
            Item::Table(table) => html.push_str(&table.html()?),
            Item::Words(words) => {
                let _ = writeln!(html, "<p>{}</p>", escape(words));
            }
            Item::Sentences(sentences) => {
                let _ = writeln!(html, "<ul>{}</ul>", elements("li", sentences));
            }
            Item::Figures(figures) => {
                let tiles: String = figures.iter().map(crate::Figure::html).collect();
                let _ = writeln!(html, "<dl class=\"tiles\">{tiles}</dl>");
            }
        }
    }
    html.push_str("</section>\n");
    Ok(html)
}

/// Each text in an element of its own.
fn elements<'a>(tag: &str, texts: impl IntoIterator<Item = &'a String>) -> String {
    texts.into_iter().fold(String::new(), |mut html, text| {
        let _ = write!(html, "<{tag}>{}</{tag}>", escape(text));
        html
    })
}

/// The frame of a plot; its numbers go to `specs`.
fn figure(
    plot: &Plot,
    section: &Section,
    number: usize,
    specs: &mut Vec<Value>,
) -> Result<String, ReportError> {
    let mut drawn = plot.draw()?;
    let id = specs.len();
    drawn.spec["title"] = json!(plot.title);
    let linked = match &plot.kind {
        crate::Kind::Lines(lines) => lines.time_range().and(section.time_range()),
        _ => None,
    };
    let mut group = String::new();
    if let Some((from, to)) = linked {
        group = format!(" data-linked=\"s{number}\"");
        drawn.spec["linked"] = json!(format!("s{number}"));
        drawn.spec["x"]["from"] = json!(from);
        drawn.spec["x"]["to"] = json!(to);
    }
    let kind = drawn.spec["kind"].as_str().unwrap_or_default().to_owned();
    let mut html = format!(
        "<figure aria-labelledby=\"t{id}\"><div class=\"head\"><h3 id=\"t{id}\">{title}</h3>\
         <div class=\"buttons\" data-for=\"{id}\"></div></div>\
         <div class=\"plot {kind}\" id=\"p{id}\"{group} role=\"img\" aria-label=\"{alt}\"></div>",
        title = escape(&plot.title),
        alt = escape(&drawn.alt),
    );
    let words = std::iter::once(&plot.words).chain(&drawn.notes).filter(|words| !words.is_empty());
    let words = elements("p", words);
    if !words.is_empty() {
        let _ = write!(html, "<figcaption>{words}</figcaption>");
    }
    html.push_str("</figure>\n");
    specs.push(drawn.spec);
    Ok(html)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Figure, Lines, Series, Table};

    const EVIL: &str = "r1</script><script>alert('\"')</script><!--&";

    /// A report with a hostile name in every place that takes a text.
    fn evil() -> Report {
        let lines = Lines::over_time(
            Axis::new(EVIL, EVIL),
            vec![Series::new(EVIL, [0.0, 1.0, 2.0], [1.0, f64::NAN, f64::INFINITY])],
        );
        let table =
            Table { title: EVIL.into(), columns: vec![Axis::new(EVIL, EVIL)], rows: vec![vec![EVIL.into()]] };
        let section = Section::new(EVIL)
            .words(EVIL)
            .with(Plot::new(EVIL, lines).words(EVIL))
            .with(table)
            .with(Item::Words(EVIL.into()))
            .with(Item::Sentences(vec![EVIL.into()]))
            .with(Item::Figures(vec![Figure::text(EVIL, EVIL).note(EVIL)]));
        Report::new(EVIL, EVIL).with(section.clone()).with(section)
    }

    fn data(html: &str) -> Value {
        let start = html.find("id=\"plots\">").unwrap() + "id=\"plots\">".len();
        let end = start + html[start..].find("</script>").unwrap();
        serde_json::from_str(&html[start..end]).unwrap()
    }

    #[test]
    fn a_script_in_a_run_name_stays_a_name() {
        let html = evil().to_html().unwrap();
        let (markup, _) = html.split_once("id=\"plots\"").unwrap();
        assert!(!markup.contains("alert('"), "a quote came through");
        assert_eq!(html.matches("<script").count(), 3, "data, ECharts and ours");
        assert_eq!(html.matches("</script").count(), 3);
        assert_eq!(data(&html)[0]["series"][0]["name"], EVIL);
    }

    #[test]
    fn the_data_hold_nulls_where_values_are_missing() {
        let html = evil().to_html().unwrap();
        assert_eq!(data(&html)[0]["series"][0]["y"], json!([1, null, null]));
    }

    #[test]
    fn plots_over_time_of_one_section_share_a_range_and_sections_do_not() {
        let lines = |to: f64| {
            Plot::new(
                "v",
                Lines::over_time(Axis::of("speed_m_s"), vec![Series::new("a", [0.0, to], [1.0, 2.0])]),
            )
        };
        let report = Report::new("t", "")
            .with(Section::new("a").with(lines(5.0)).with(lines(9.0)))
            .with(Section::new("b").with(lines(3.0)));
        let data = data(&report.to_html().unwrap());
        assert_eq!([&data[0]["x"]["to"], &data[1]["x"]["to"], &data[2]["x"]["to"]], [9.0, 9.0, 3.0]);
        assert_eq!(data[0]["linked"], data[1]["linked"]);
        assert_ne!(data[0]["linked"], data[2]["linked"]);
    }

    #[test]
    fn the_page_asks_for_nothing_from_elsewhere() {
        let html = evil().to_html().unwrap();
        let own = html.replace(ECHARTS, "");
        for reach in ["src=\"", "href=\"http", "@import", "url(", "fetch(", "https://"] {
            assert!(!own.contains(reach), "{reach}");
        }
        assert!(html.contains("default-src 'none'"));
    }

    #[test]
    fn no_asset_ends_its_own_element() {
        for asset in [ECHARTS, SCRIPT] {
            assert!(!asset.contains("</script") && !asset.contains("<!--"));
        }
        assert!(!STYLE.contains("</style"));
    }
}
