//! Rules of the workspace that no compiler checks.

use crate::process::{self, Done, failed};

/// Two versions of one of these do not fit together, and the compiler says so in the oddest ways.
const ONCE: [&str; 4] = ["wgpu", "wgpu-core", "naga", "glam"];

/// What talks to a GPU. Names that end in `-` are families.
const GPU_APIS: [&str; 12] = [
    "wgpu",
    "wgpu-",
    "ash",
    "metal",
    "objc2-metal",
    "objc2-quartz-",
    "windows",
    "d3d12",
    "glow",
    "khronos-egl",
    "gpu-allocator",
    "web-sys",
];

/// Each of [`ONCE`] stands once in `Cargo.lock`.
pub fn one_version_each() -> Done {
    let path = process::root().join("Cargo.lock");
    let lock = std::fs::read_to_string(&path).map_err(|e| failed(format!("{}: {e}", path.display())))?;
    versions_of(&lock, &ONCE).map_err(failed)
}

fn versions_of(lock: &str, names: &[&str]) -> Result<(), String> {
    for name in names {
        let line = format!("name = \"{name}\"");
        let packages = lock.split("[[package]]").filter(|package| package.lines().any(|l| l == line));
        let versions: Vec<_> = packages
            .filter_map(|package| package.lines().find_map(|l| l.strip_prefix("version = ")))
            .collect();
        match versions.as_slice() {
            [_] => {}
            [] => return Err(format!("Cargo.lock has no {name}; was it renamed? (xtask/src/checks.rs)")),
            many => return Err(format!("Cargo.lock has {name} {}; there must be one", many.join(" and "))),
        }
    }
    Ok(())
}

/// `umbrage-core` can be used without any GPU API: nothing below it is one.
pub fn core_without_gpu() -> Done {
    let tree = process::stdout(&mut process::cargo([
        "tree",
        "--package",
        "umbrage-core",
        "--edges",
        "normal",
        "--target",
        "all",
        "--prefix",
        "none",
    ]))?;
    gpu_apis_in(&tree).map_err(failed)
}

fn gpu_apis_in(tree: &str) -> Result<(), String> {
    let packages: Vec<&str> = tree.lines().filter_map(|line| line.split_whitespace().next()).collect();
    // An empty answer is no proof.
    if packages.first() != Some(&"umbrage-core") || !packages.contains(&"glam") {
        return Err("cargo tree does not list umbrage-core and what it needs".to_owned());
    }
    let is_gpu_api = |name: &&&str| {
        GPU_APIS.iter().any(|api| if api.ends_with('-') { name.starts_with(api) } else { *name == api })
    };
    match packages.iter().find(is_gpu_api) {
        Some(name) => Err(format!("umbrage-core depends on {name}; it must do without any GPU API")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_version_is_seen_and_so_is_none() {
        let package = |name: &str, version: &str| {
            format!("[[package]]\nname = \"{name}\"\nversion = \"{version}\"\n\n")
        };
        let one = package("naga", "30.0.1") + &package("naga-types", "30.0.0");
        assert_eq!(versions_of(&one, &["naga"]), Ok(()));
        let two = one.clone() + &package("naga", "29.0.0");
        let message = versions_of(&two, &["naga"]).expect_err("two versions");
        assert!(message.contains("\"30.0.1\" and \"29.0.0\""), "{message}");
        assert!(versions_of(&one, &["glam"]).is_err());
    }

    #[test]
    fn a_gpu_api_below_core_is_seen_and_so_is_an_empty_tree() {
        let tree = "umbrage-core v0.1.0 (/x)\nbytemuck v1\nglam v0.34.3\n";
        assert_eq!(gpu_apis_in(tree), Ok(()));
        for name in ["wgpu", "wgpu-hal", "ash", "metal"] {
            assert!(gpu_apis_in(&format!("{tree}{name} v1\n")).expect_err(name).contains(name));
        }
        assert!(gpu_apis_in("").is_err());
    }
}
