//! The page put together: its sources with the facts and arrays set into them.

use super::pack::Array;
use serde_json::Value;
use std::io::{self, Write};

const TEMPLATE: &str = include_str!("page/index.html");
const STYLE: &str = include_str!("page/style.css");

/// The modules in an order in which each comes after those that it imports.
const MODULES: [&str; 21] = [
    include_str!("page/format.js"),
    include_str!("page/data.js"),
    include_str!("page/quantities.js"),
    include_str!("page/geometry.js"),
    include_str!("page/matrix.js"),
    include_str!("page/camera.js"),
    include_str!("page/gl.js"),
    include_str!("page/strokes.js"),
    include_str!("page/disk.js"),
    include_str!("page/view.js"),
    include_str!("page/state.js"),
    include_str!("page/input.js"),
    include_str!("page/elements.js"),
    include_str!("page/plots.js"),
    include_str!("page/scale.js"),
    include_str!("page/planes.js"),
    include_str!("page/looks.js"),
    include_str!("page/face.js"),
    include_str!("page/tables.js"),
    include_str!("page/export.js"),
    include_str!("page/main.js"),
];

const SHADERS: [(&str, &str); 6] = [
    ("mesh.vert", include_str!("page/mesh.vert.glsl")),
    ("mesh.frag", include_str!("page/mesh.frag.glsl")),
    ("number.frag", include_str!("page/number.frag.glsl")),
    ("edges.vert", include_str!("page/edges.vert.glsl")),
    ("strokes.vert", include_str!("page/strokes.vert.glsl")),
    ("line.frag", include_str!("page/line.frag.glsl")),
];

/// One mesh: what is told of it, and its arrays.
pub(super) struct Model {
    pub(super) facts: Value,
    pub(super) arrays: Vec<Array>,
}

/// Writes the page.
pub(super) fn write(out: &mut dyn Write, shared: &Value, models: &[Model]) -> io::Result<()> {
    let names: Vec<&str> = models.iter().filter_map(|model| model.facts["name"].as_str()).collect();
    let title = format!("{} - curvature", names.join(" and "));
    for (i, part) in TEMPLATE.split("<!--").enumerate() {
        let rest = match part.split_once("-->") {
            Some((mark, rest)) if i > 0 => {
                match mark.trim() {
                    "title" => out.write_all(text(&title).as_bytes())?,
                    "style" => out.write_all(STYLE.as_bytes())?,
                    "shaders" => shaders(out)?,
                    "data" => data(out, shared, models)?,
                    "script" => script(out)?,
                    _ => {}
                }
                rest
            }
            _ => part,
        };
        out.write_all(rest.as_bytes())?;
    }
    Ok(())
}

fn shaders(out: &mut dyn Write) -> io::Result<()> {
    for (name, source) in SHADERS {
        writeln!(out, "<script type=\"x-shader\" id=\"{name}\">{}</script>", source.trim_start())?;
    }
    Ok(())
}

/// The modules as one: what they import from one another is in the same scope. Comments stay behind.
fn script(out: &mut dyn Write) -> io::Result<()> {
    let is_import = |line: &&str| line.starts_with("import ");
    let is_comment = |line: &&str| line.trim_start().starts_with("//");
    for line in MODULES.into_iter().flat_map(str::lines).filter(|line| !is_import(line) && !is_comment(line)) {
        writeln!(out, "{}", line.strip_prefix("export ").unwrap_or(line))?;
    }
    Ok(())
}

fn data(out: &mut dyn Write, shared: &Value, models: &[Model]) -> io::Result<()> {
    let mut facts = shared.clone();
    facts["models"] = models.iter().map(|model| model.facts.clone()).collect();
    writeln!(out, "<script type=\"application/json\" id=\"facts\">{}</script>", json(&facts))?;
    for (m, model) in models.iter().enumerate() {
        for array in &model.arrays {
            // Names are ours and base64 has no character that HTML knows.
            writeln!(out, "<script type=\"text/plain\" id=\"{m}-{}\">{}</script>", array.name, array.text)?;
        }
    }
    Ok(())
}

/// JSON inside a script element: no `<` that could end or open one, no line separators, and names shown as
/// they are read, whatever marks of direction they hold.
fn json(value: &Value) -> String {
    let mut safe = String::new();
    for c in visible(value).to_string().chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => safe.push_str(&format!("\\u{:04x}", c as u32)),
            _ => safe.push(c),
        }
    }
    safe
}

/// The same with every text made visible.
fn visible(value: &Value) -> Value {
    match value {
        Value::String(text) => plain(text).into(),
        Value::Array(all) => all.iter().map(visible).collect(),
        Value::Object(all) => all.iter().map(|(name, value)| (plain(name), visible(value))).collect(),
        other => other.clone(),
    }
}

/// Text without marks that turn the direction of what follows, hide, or end a line: each is replaced by a sign
/// that shows its place.
fn plain(text: &str) -> String {
    let is_hidden = |c: char| {
        c.is_control()
            || matches!(c, '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
    };
    text.chars().map(|c| if is_hidden(c) { '\u{fffd}' } else { c }).collect()
}

/// Text inside an element.
fn text(text: &str) -> String {
    plain(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn page(name: &str) -> String {
        let model = Model { facts: json!({ "name": name, "groups": [{ "name": name }] }), arrays: Vec::new() };
        let mut out = Vec::new();
        write(&mut out, &json!({ "schema": 1 }), &[model]).expect("memory");
        String::from_utf8(out).expect("text")
    }

    #[test]
    fn hostile_names_stay_text() {
        let harmless = page("part");
        let count = |page: &str, what: &str| page.matches(what).count();
        for name in [
            "</script><script>alert(1)</script>",
            "<!--<script>",
            "\"'`</title><img src=x onerror=alert(1)>",
            "a\u{202e}lts.exe\u{2028}\u{0}\u{7f}",
            "-->",
            "${alert(1)}\\",
            "]]>&lt;",
        ] {
            let page = page(name);
            for mark in ["<script", "</script", "<!--", "-->", "<img", "</title", "\u{202e}", "\u{2028}", "\u{0}"] {
                assert_eq!(count(&page, mark), count(&harmless, mark), "{mark} in {name:?}");
            }
            let facts = page.split("id=\"facts\">").nth(1).and_then(|s| s.split("</script>").next()).expect("facts");
            let facts: Value = serde_json::from_str(facts).expect("JSON");
            assert_eq!(facts["models"][0]["groups"][0]["name"], plain(name));
        }
    }

    #[test]
    fn the_modules_names_do_not_meet() {
        let mut seen = std::collections::BTreeSet::new();
        for line in MODULES.into_iter().flat_map(str::lines).map(|line| line.strip_prefix("export ").unwrap_or(line)) {
            let words: Vec<&str> = line.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
            let name = match words.as_slice() {
                ["async", "function", name, ..] | ["function" | "class" | "const" | "let", name, ..] => *name,
                _ => continue,
            };
            assert!(name.is_empty() || seen.insert(name), "{name} stands in two modules");
        }
        assert!(seen.len() > 100, "{} names", seen.len());
    }

    #[test]
    fn the_modules_leave_no_import_behind() {
        let page = page("part");
        assert!(!page.lines().any(|line| line.starts_with("import ") || line.starts_with("export ")));
        assert!(
            !page.contains("src=") && !page.contains("http://") && !page.contains("https://"),
            "nothing is fetched"
        );
        assert!(page.len() < 150_000, "{} bytes before any face", page.len());
    }
}
