//! The live page: events of a server in, pictures and charts out. It asks for nothing but those
//! events.

use super::{DRAWING, SHARED_STYLE, escaped};
use linestereo::objects::Reason;
use linestereo_wire::Health;
use serde_json::json;

const PAGE: &str = include_str!("live.html");
const SCRIPT: &str = include_str!("live.js");

/// The page of this source, a name for people. The server's word `nonce` marks its scripts and
/// styles.
pub fn page(source: &str, nonce: &str) -> String {
    // Flags and reasons share names.
    let reasons = Reason::ALL.map(|reason| (reason.name(), reason.to_string()));
    let words =
        json!({"flags": Health::ADVICE, "reasons": reasons}).to_string().replace('<', "\\u003c");
    // Behind what it imports it needs no imports.
    let script: String =
        SCRIPT.split_inclusive('\n').filter(|line| !line.starts_with("import ")).collect();
    let parts = [
        ("/*NONCE*/", nonce),
        ("/*STYLE*/", SHARED_STYLE),
        ("/*WORDS*/", &words),
        ("/*SCRIPT*/", &[DRAWING, &script].concat()),
        ("/*SOURCE*/", &escaped(source)),
    ];
    parts.into_iter().fold(PAGE.to_owned(), |page, (place, part)| page.replace(place, part))
}
