//! Rules for the adapter's workspace, which is separate from the main program. The codec and the core use neither an
//! operating system nor unsafe code, and every module is documented and short.

use std::fs;
use std::path::{Path, PathBuf};

/// Returns the source files in the given folders of the adapter's workspace, with their content.
pub(crate) fn adapter_sources(folders: &[&str]) -> Vec<(PathBuf, String)> {
    let mut files = Vec::new();
    for folder in folders {
        super::collect(&Path::new(env!("CARGO_MANIFEST_DIR")).join("adapter").join(folder), &mut files);
    }
    assert!(files.len() >= folders.len(), "{folders:?}");
    files.into_iter().map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

#[test]
fn adapter_core_needs_no_operating_system() {
    for folder in ["codec/src", "core/src"] {
        let root = &adapter_sources(&[folder]).into_iter().find(|(path, _)| path.ends_with("lib.rs")).unwrap().1;
        assert!(root.contains("#![no_std]") && root.contains("#![forbid(unsafe_code)]"), "{folder}");
    }
}

#[test]
fn adapter_modules_are_documented_and_short() {
    for (path, text) in adapter_sources(&["codec/src", "core/src", "core/tests", "firmware/src"]) {
        assert!(text.starts_with("//!"), "{} does not open with //!", path.display());
        let length = text.lines().count();
        assert!(length <= 450, "{} has {length} lines: split it by concept", path.display());
    }
}
