//! Definitions of the messages that are sent, each with those that it refers to, as `ros2 bag`
//! writes them.
//!
//! # Source
//! `definitions.txt`: the `.msg` files of ROS 2 Humble without their comments. They are the same in
//! Jazzy.

use core::fmt::Write;

const DEFINITIONS: &str = include_str!("definitions.txt");
/// Between two definitions in one text.
const LINE: &str =
    "================================================================================";

/// The definition of `package/Message`, and below it every other one that it needs, once.
pub fn definition(name: &str) -> String {
    let mut names = vec![name];
    let mut text = String::new();
    let mut at = 0;
    while let Some(&name) = names.get(at) {
        let body = of(name);
        if at > 0 {
            let _ = write!(text, "{LINE}\nMSG: {name}\n");
        }
        text.push_str(body);
        for field in body.lines() {
            let kind = field.split([' ', '[']).next().unwrap_or_default();
            if kind.contains('/') && !names.contains(&kind) {
                names.push(kind);
            }
        }
        at += 1;
    }
    text
}

/// The lines of one; none of what is not defined.
fn of(name: &str) -> &'static str {
    let all = DEFINITIONS.split("MSG: ");
    let found =
        all.filter_map(|definition| definition.split_once('\n')).find(|(of, _)| *of == name);
    found.map_or("", |(_, body)| {
        body.strip_suffix("\n\n").map_or(body, |short| &body[..=short.len()])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_definition_comes_with_what_it_refers_to() {
        let expected = format!(
            "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n{LINE}\nMSG: std_msgs/Header\n\
             builtin_interfaces/Time stamp\nstring frame_id\n{LINE}\nMSG: diagnostic_msgs/DiagnosticStatus\n\
             byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\nstring name\nstring message\n\
             string hardware_id\ndiagnostic_msgs/KeyValue[] values\n{LINE}\nMSG: builtin_interfaces/Time\n\
             int32 sec\nuint32 nanosec\n{LINE}\nMSG: diagnostic_msgs/KeyValue\nstring key\nstring value\n"
        );
        assert_eq!(definition("diagnostic_msgs/DiagnosticArray"), expected);
    }

    #[test]
    fn nothing_that_is_referred_to_is_missing() {
        for definition in DEFINITIONS.split("MSG: ").filter(|text| !text.is_empty()) {
            for field in definition.lines().skip(1) {
                let kind = field.split([' ', '[']).next().unwrap();
                assert!(!kind.contains('/') || !of(kind).is_empty(), "{kind}");
            }
        }
    }
}
