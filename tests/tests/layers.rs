//! Modules depend on each other one way: a circle of `use` fails, between the modules at the top of
//! a crate and between those of each folder inside it. No file of the repository is a link.
//!
//! A path counts where it leads: what a module re-exports belongs to the module that it comes from.
//! Tests and comments do not count, nor what a folder's own `mod.rs` and the modules in it name of
//! each other.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// By module, those whose items it names.
type Graph = BTreeMap<String, BTreeSet<String>>;
/// Of a module or an item, from the crate's root.
type Place = Vec<String>;
/// The code of each module.
type Modules = BTreeMap<Place, String>;

/// Crates, and how many modules stand at the top of each at least.
const CRATES: [(&str, usize); 11] = [
    ("core/src", 24),
    ("crates/calibration/src", 4),
    ("crates/frames/src", 15),
    ("crates/lab/src", 6),
    ("crates/mavlink/src", 4),
    ("crates/recordings/src", 5),
    ("crates/rig/src", 9),
    ("crates/scenes/src", 5),
    ("crates/wire/src", 8),
    ("firmware/src", 20),
    ("host-sim/src", 16),
];

fn read(folder: &Path, place: &Place, modules: &mut Modules) {
    for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let name = entry.file_stem().unwrap().to_str().unwrap().to_owned();
        let inner = [place.as_slice(), core::slice::from_ref(&name)].concat();
        if entry.is_dir() {
            read(&entry, &inner, modules);
        } else if entry.extension().is_some_and(|extension| extension == "rs") && name != "main" {
            let text = std::fs::read_to_string(&entry).unwrap();
            modules.insert(
                if name == "mod" || name == "lib" { place.clone() } else { inner },
                code(&text),
            );
        }
    }
}

fn code(text: &str) -> String {
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap();
    code.lines().map(|line| line.split("//").next().unwrap()).collect::<Vec<_>>().join("\n")
}

/// The paths of a tree of `use`, its braces written out.
fn leaves(tree: &str) -> Vec<String> {
    let Some((head, rest)) = tree.split_once('{') else {
        return vec![tree.split(" as ").next().unwrap().trim().to_owned()];
    };
    let (mut depth, mut items) = (0, vec![String::new()]);
    for c in rest.chars() {
        match c {
            '}' if depth == 0 => break,
            ',' if depth == 0 => items.push(String::new()),
            _ => {
                depth += i32::from(c == '{') - i32::from(c == '}');
                items.last_mut().unwrap().push(c);
            }
        }
    }
    let items = items.iter().filter(|item| !item.trim().is_empty());
    items.flat_map(|item| leaves(item)).map(|leaf| format!("{}{leaf}", head.trim())).collect()
}

/// The paths of each statement `use`, and whether it is a re-export.
fn uses(code: &str) -> impl Iterator<Item = (bool, Vec<String>)> {
    let starts = code.match_indices("use ").filter(|(at, _)| {
        let line = code[..*at].rsplit('\n').next().unwrap().trim();
        line.is_empty() || line.starts_with("pub")
    });
    starts.map(|(at, start)| {
        let is_public = code[..at].rsplit('\n').next().unwrap().trim().starts_with("pub");
        (is_public, leaves(code[at + start.len()..].split(';').next().unwrap()))
    })
}

/// Paths in the middle of code.
fn inline(code: &str) -> impl Iterator<Item = String> {
    let starts = ["crate::", "super::"].into_iter().flat_map(|start| code.match_indices(start));
    let starts = starts.filter(|(at, _)| {
        !code[..*at].ends_with(|c: char| c == ':' || c == '_' || c.is_alphanumeric())
    });
    let is_path = |c: &char| *c == ':' || *c == '_' || c.is_alphanumeric();
    starts.map(move |(at, _)| code[at..].chars().take_while(is_path).collect())
}

/// Where a path leads from the root; nothing for other crates'.
fn resolved(path: &str, module: &Place, modules: &Modules) -> Option<Place> {
    let mut parts: Vec<String> =
        path.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect();
    let mut place = module.clone();
    match parts.first()?.as_str() {
        "crate" => place.clear(),
        "self" | "super" => {}
        first if modules.contains_key(&[module.as_slice(), &[first.to_owned()]].concat()) => {}
        _ => return None,
    }
    while let Some("crate" | "self" | "super") = parts.first().map(String::as_str) {
        if parts.remove(0) == "super" {
            place.pop();
        }
    }
    if parts.last().is_some_and(|last| last == "self") {
        parts.pop();
    }
    Some([place, parts].concat())
}

/// Graph of each folder: modules and the siblings that they name.
fn graphs(modules: &Modules) -> BTreeMap<Place, Graph> {
    let mut origin: BTreeMap<Place, Place> = BTreeMap::new();
    for (module, code) in modules {
        for path in uses(code).filter(|(is_public, _)| *is_public).flat_map(|(_, paths)| paths) {
            if let Some(from) = resolved(&path, module, modules) {
                let name = from.last().unwrap().clone();
                origin.insert([module.as_slice(), &[name]].concat(), from);
            }
        }
    }
    let mut graphs: BTreeMap<Place, Graph> = BTreeMap::new();
    for (module, code) in modules {
        let paths = uses(code).flat_map(|(_, paths)| paths).chain(inline(code));
        for mut place in paths.filter_map(|path| resolved(&path, module, modules)) {
            // A function may be called like the module that it comes from.
            while let Some(length) =
                (1..=place.len()).find(|&length| !modules.contains_key(&place[..length]))
                && let Some(from) = origin.get(&place[..length])
            {
                place = [from.as_slice(), &place[length..]].concat();
            }
            let common = module.iter().zip(&place).take_while(|(a, b)| a == b).count();
            if common < module.len()
                && common < place.len()
                && modules.contains_key(&place[..=common])
            {
                let graph = graphs.entry(module[..common].to_vec()).or_default();
                graph.entry(place[common].clone()).or_default();
                graph.entry(module[common].clone()).or_default().insert(place[common].clone());
            }
        }
    }
    graphs
}

/// The modules that are left when those that depend on none of them are taken away, again and
/// again.
fn circles(mut graph: Graph) -> Graph {
    loop {
        let left: BTreeSet<String> = graph.keys().cloned().collect();
        let before = graph.len();
        graph.retain(|_, named| named.iter().any(|name| left.contains(name)));
        if graph.len() == before {
            let left: BTreeSet<String> = graph.keys().cloned().collect();
            graph.values_mut().for_each(|named| named.retain(|name| left.contains(name)));
            return graph;
        }
    }
}

#[test]
fn modules_form_no_circle() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (crate_folder, least) in CRATES {
        let mut modules = Modules::new();
        read(&top.join(crate_folder), &Vec::new(), &mut modules);
        let graphs = graphs(&modules);
        let at_top = &graphs[&Vec::new()];
        assert!(at_top.len() >= least, "{crate_folder}: {:?}", at_top.keys());
        let found: usize = at_top.values().map(BTreeSet::len).sum();
        assert!(found + 1 >= at_top.len(), "{crate_folder}: {found} uses of each other are found");
        for (place, graph) in graphs {
            let folder = [&[crate_folder.to_owned()], place.as_slice()].concat().join("/");
            let circles = circles(graph);
            assert!(circles.is_empty(), "{folder}: {circles:#?}");
        }
    }
}

#[test]
fn a_circle_is_found() {
    let of = |pairs: &[(&str, &str)]| {
        let mut graph = Graph::new();
        for (module, named) in pairs {
            graph.entry((*module).to_owned()).or_default().insert((*named).to_owned());
        }
        circles(graph).len()
    };
    assert_eq!(of(&[("a", "b"), ("b", "c"), ("c", "a"), ("d", "a"), ("e", "f")]), 4);
    assert_eq!(of(&[("a", "b"), ("b", "c"), ("d", "a")]), 0);
}

#[test]
fn uses_are_followed_to_where_they_lead() {
    let sources = [
        ("", "pub mod a;\npub mod b;\npub use a::{one::One, two::Two};\n"),
        ("a", "mod one;\nmod two;\npub use one::One;\n"),
        (
            "a::one",
            "use super::two::{self, Two};\nuse std::fmt;\n#[cfg(test)]\nmod tests \
             { use crate::b::C; }\n",
        ),
        ("a::two", "pub struct Two; // crate::b\nfn one(_: super::One) {}\n"),
        ("b", "use crate::{\n    Two,\n    a::{self as first, One as Eins},\n};\n"),
    ];
    let place = |path: &str| {
        path.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect::<Place>()
    };
    let modules: Modules = sources.iter().map(|(path, text)| (place(path), code(text))).collect();
    let graphs = graphs(&modules);
    let named = |folder: &str, module: &str| {
        graphs[&place(folder)][module].iter().cloned().collect::<Vec<_>>()
    };
    assert_eq!((named("", "a"), named("", "b")), (vec![], vec!["a".to_owned()]));
    assert_eq!(
        (named("a", "one"), named("a", "two")),
        (vec!["two".to_owned()], vec!["one".to_owned()])
    );
    assert_eq!(circles(graphs[&place("a")].clone()).len(), 2);
}

/// Checkouts on Windows have no links: their text is taken for the file.
#[test]
fn no_file_is_a_link_and_licences_are_copies() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let git = std::process::Command::new("git").args(["ls-files", "-s"]).current_dir(&top).output();
    let Some(output) = git.ok().filter(|output| output.status.success()) else { return };
    let files = String::from_utf8(output.stdout).unwrap();
    assert!(files.lines().count() > 100);
    for (about, path) in files.lines().map(|line| line.split_once('\t').unwrap()) {
        assert!(!about.starts_with("120000"), "{path} is a link");
        if let Some((_, name)) = path.rsplit_once("/LICENSE-") {
            let read = |path: &str| std::fs::read(top.join(path)).unwrap();
            assert_eq!(read(path), read(&format!("LICENSE-{name}")), "{path}");
        }
    }
}
