//! Loading of encoder descriptions. User-defined descriptions take precedence over built-in ones.

use crate::devices::biss::protocol::{Descriptions, KIND};
use crate::profile::Cause;
use crate::store::{Store, StoreError, read_folder};

/// Returns the encoder descriptions, user-defined ones first, and a `DescriptionError` for each file that cannot be
/// used.
pub fn load_descriptions(store: &Store) -> (Descriptions, Vec<StoreError>) {
    let (files, unread) = read_folder(&store.device_folder(KIND), "ron");
    let (own, broken) = Descriptions::read(files.iter().map(|(name, text)| (name.as_str(), text.as_str())));
    let broken = broken.into_iter().map(|error| StoreError::Refused(Cause::new(error)));
    let errors = unread.into_iter().map(StoreError::from).chain(broken).collect();
    (Descriptions::built_in().merged_with(own), errors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn reports_file_and_line_of_description_error() {
        let root = tempfile::tempdir().unwrap();
        let store = Store::at_root(root.path());
        assert_eq!(load_descriptions(&store), (Descriptions::built_in(), Vec::new()));
        let folder = store.device_folder(KIND);
        fs::create_dir_all(folder.join("folder.ron")).unwrap();
        fs::write(folder.join("broken.ron"), "(\n  name: \"mine\",\n  register: [],\n)").unwrap();
        fs::write(folder.join("latin.ron"), b"(name: \"\xFC\")").unwrap();
        fs::write(folder.join("notes.txt"), "no description").unwrap();
        let (_, unknown) = Descriptions::BUILT_IN[1];
        fs::write(folder.join("own.RON"), unknown.replace("\"BiSS C encoder\"", "\"own\"")).unwrap();
        let (known, errors) = load_descriptions(&store);
        assert!(known.find_by_name("own").is_some() && known.find_by_name("POSITAL IXARC kit encoder").is_some());
        let texts: Vec<String> = errors.iter().map(ToString::to_string).collect();
        let [folder, latin, broken] = texts.as_slice() else { panic!("{texts:?}") };
        assert!(folder.contains("folder.ron: it is a folder"), "{folder}");
        assert!(latin.contains("latin.ron: it is not UTF-8 text: byte 8 is not valid"), "{latin}");
        assert!(broken.contains("broken.ron, line 3, column "), "{broken}");
    }
}
