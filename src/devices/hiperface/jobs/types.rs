//! The table of encoder types, in which user-defined rows take precedence over built-in rows.

use std::path::PathBuf;

use crate::devices::hiperface::protocol::{EncoderTypes, KIND, TypeTableError};
use crate::profile::Cause;
use crate::store::{FileError, FileErrorKind, Store, StoreError, read_text};

/// An error in the user-defined table of encoder types.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}, {cause}", path.display())]
pub struct TypeTableFileError {
    pub path: PathBuf,
    pub cause: TypeTableError,
}

/// Returns the table of encoder types, in which user-defined rows take precedence over built-in rows.
///
/// # Errors
/// Returns a [`TypeTableFileError`] if the user's file exists but cannot be read or parsed. In this case,
/// [`EncoderTypes::built_in`] can be used instead.
pub fn encoder_types(store: &Store) -> Result<EncoderTypes, StoreError> {
    let built_in = EncoderTypes::built_in();
    let path = store.device_file(KIND);
    let text = match read_text(&path) {
        Ok(text) => text,
        Err(FileError { problem: FileErrorKind::NotFound, .. }) => return Ok(built_in),
        Err(error) => return Err(error.into()),
    };
    match EncoderTypes::parse(&text) {
        Ok(own) => Ok(built_in.merged_with(own)),
        Err(cause) => Err(StoreError::Refused(Cause::new(TypeTableFileError { path, cause }))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn store_with_table(own: &[u8]) -> (tempfile::TempDir, Store) {
        let root = tempfile::tempdir().unwrap();
        let store = Store::at_root(root.path());
        fs::create_dir_all(store.device_file(KIND).parent().unwrap()).unwrap();
        fs::write(store.device_file(KIND), own).unwrap();
        (root, store)
    }

    #[test]
    fn reading_creates_no_folder() {
        let root = tempfile::tempdir().unwrap();
        let store = Store::at_root(root.path());
        assert_eq!(encoder_types(&store), Ok(EncoderTypes::built_in()));
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
    }

    #[test]
    fn user_encoder_type_takes_precedence() {
        let (_root, store) = store_with_table("\u{FEFF}(types: [(code: 0x37, name: \"own\")])".as_bytes());
        let types = encoder_types(&store).unwrap();
        assert_eq!(types.find(0x37).unwrap().name, "own");
        assert_eq!(types.find(0x22), EncoderTypes::built_in().find(0x22));
    }

    #[test]
    fn broken_table_error_has_location() {
        let (_root, store) = store_with_table(b"(types: [\n  (code: 0x37, nam: \"own\")])");
        let error = encoder_types(&store).unwrap_err();
        let StoreError::Refused(cause) = &error else { panic!("{error:?}") };
        let broken = cause.get::<TypeTableFileError>().unwrap();
        assert!(matches!(broken.cause, TypeTableError::Syntax { line: 2, .. }));
        let text = error.to_string();
        assert!(text.contains("hiperface.ron, line 2, column "), "{text}");

        let (_root, store) = store_with_table(b"(types: \xFF)");
        let error = encoder_types(&store).unwrap_err();
        assert!(
            matches!(&error, StoreError::File(FileError { problem: FileErrorKind::NotUtf8 { offset: 8 }, .. })),
            "{error}"
        );
    }
}
