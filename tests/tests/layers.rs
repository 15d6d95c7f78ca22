//! Modules depend on each other one way: a circle of `use` between the folders of a crate fails.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

type Graph = BTreeMap<String, BTreeSet<String>>;

fn sources(folder: &Path, list: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_dir() {
            sources(&entry, list);
        } else if entry.extension().is_some_and(|extension| extension == "rs") {
            list.push(entry);
        }
    }
}

/// The modules at the top of a crate, and those whose items each of them names. Tests and comments do not count.
fn graph(folder: &Path) -> Graph {
    let mut files = Vec::new();
    sources(folder, &mut files);
    let mut graph = Graph::new();
    for file in files {
        let path = file.strip_prefix(folder).unwrap().with_extension("");
        let module = path.iter().next().unwrap().to_str().unwrap().to_owned();
        if module == "lib" {
            continue;
        }
        let text = std::fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        let named = graph.entry(module.clone()).or_default();
        for line in code.lines().map(|line| line.split("//").next().unwrap()) {
            for rest in line.split("crate::").skip(1) {
                let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                // What the root re-exports begins with a capital.
                if name.starts_with(char::is_lowercase) && name != module {
                    named.insert(name);
                }
            }
        }
    }
    graph
}

/// The modules that are left when those that depend on none of them are taken away, again and again.
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
    for (folder, modules) in [("core/src", 24), ("crates/rig/src", 9), ("crates/wire/src", 8), ("firmware/src", 20)] {
        let graph = graph(&top.join(folder));
        assert!(graph.len() >= modules, "{folder}: {:?}", graph.keys());
        assert!(graph.values().any(|named| named.len() > 3), "{folder}: nothing is found");
        let circles = circles(graph);
        assert!(circles.is_empty(), "{folder}: {circles:#?}");
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
