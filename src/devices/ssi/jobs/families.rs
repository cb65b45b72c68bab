//! The built-in and user-defined families of encoders.

use crate::devices::ssi::protocol::{Families, KIND};
use crate::profile::Cause;
use crate::store::{Store, StoreError, read_folder};

/// Returns the encoder families, with an error for each file that cannot be used. User-defined families replace
/// built-in ones with the same key.
pub fn families(store: &Store) -> (Families, Vec<StoreError>) {
    let (files, unread) = read_folder(&store.device_folder(KIND), "ron");
    let (own, broken) = Families::read(files.iter().map(|(name, text)| (name.as_str(), text.as_str())));
    let broken = broken.into_iter().map(|error| StoreError::Refused(Cause::new(error)));
    let errors = unread.into_iter().map(StoreError::from).chain(broken).collect();
    (Families::built_in().merged_with(own), errors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn user_families_precede_built_in() {
        let root = tempfile::tempdir().unwrap();
        let store = Store::at_root(root.path());
        assert_eq!(families(&store), (Families::built_in(), Vec::new()));
        let folder = store.device_folder(KIND);
        fs::create_dir_all(&folder).unwrap();
        let (_, ahs36) = Families::BUILT_IN[0];
        fs::write(folder.join("same.ron"), ahs36.replace("\"AHS36 SSI\"", "\"my AHS36\"")).unwrap();
        fs::write(folder.join("other.ron"), ahs36.replace("\"ahs36\"", "\"mine\"")).unwrap();
        fs::write(folder.join("broken.ron"), "(\n  key: \"x\",\n  nam: \"x\",\n)").unwrap();
        let (known, errors) = families(&store);
        assert_eq!(known.find_by_key("ahs36").unwrap().name, "my AHS36");
        assert!(known.find_by_key("mine").is_some() && known.find_by_key("kh53").is_some());
        assert_eq!(known.iter().count(), 12);
        let [error] = errors.as_slice() else { panic!("{errors:?}") };
        assert!(error.to_string().contains("broken.ron, line 3, column "), "{error}");
    }
}
