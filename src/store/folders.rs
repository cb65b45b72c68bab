//! The base folders of relative paths. Command-line, typed and dropped paths follow the same rule.

use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

use directories::UserDirs;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BaseFolders {
    working: Option<PathBuf>,
    home: Option<PathBuf>,
}

impl BaseFolders {
    /// Returns the working folder of the program and the home folder of the user.
    pub fn for_current_user() -> Self {
        let home = UserDirs::new().map(|own| own.home_dir().to_owned());
        BaseFolders { working: std::env::current_dir().ok(), home }
    }

    pub fn with_base_folders(working: &Path, home: &Path) -> Self {
        BaseFolders { working: Some(working.to_owned()), home: Some(home.to_owned()) }
    }

    /// Returns the base folder of relative paths, or `None` if the system does not report it.
    pub fn working_folder(&self) -> Option<&Path> {
        self.working.as_deref()
    }

    /// Returns the user's home folder, or `None` if the system does not report it.
    pub fn home_folder(&self) -> Option<&Path> {
        self.home.as_deref()
    }

    /// Returns the absolute path of a file. A leading `~` is replaced with the user's home folder. Other relative paths
    /// are resolved against the working folder.
    pub fn absolute_path(&self, path: &Path) -> PathBuf {
        let mut parts = path.components();
        let from_home = parts.next() == Some(Component::Normal(OsStr::new("~")));
        match (&self.home, &self.working) {
            (Some(home), _) if from_home => home.join(parts.as_path()),
            // An empty path remains empty.
            (_, Some(working)) if !path.as_os_str().is_empty() => working.join(path.strip_prefix(".").unwrap_or(path)),
            _ => path.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_resolve_consistently() {
        let root = std::env::temp_dir();
        let (working, home) = (root.join("work"), root.join("home"));
        let folders = BaseFolders::with_base_folders(&working, &home);
        let elsewhere = root.join("elsewhere.ron");
        let cases = [
            ("a.ron", working.join("a.ron")),
            ("./a.ron", working.join("a.ron")),
            ("sub/a.ron", working.join("sub").join("a.ron")),
            ("~/a.ron", home.join("a.ron")),
            ("~", home.clone()),
            // A file name that begins with `~` and does not refer to the home folder.
            ("~a.ron", working.join("~a.ron")),
            ("sub/~/a.ron", working.join("sub/~/a.ron")),
        ];
        for (given, expected) in cases {
            assert_eq!(folders.absolute_path(Path::new(given)), expected, "{given}");
        }
        assert_eq!(folders.absolute_path(&elsewhere), elsewhere);
        assert_eq!(folders.absolute_path(Path::new("")), PathBuf::new());
        assert_eq!(BaseFolders::default().absolute_path(Path::new("~/a.ron")), PathBuf::from("~/a.ron"));
    }
}
