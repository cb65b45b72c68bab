//! The base folders of relative paths, and the folder of the ready-made profiles. Command-line, typed and dropped paths
//! follow the same rule.

use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

use directories::UserDirs;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BaseFolders {
    working: Option<PathBuf>,
    home: Option<PathBuf>,
    /// Folder that contains the program.
    program: Option<PathBuf>,
}

impl BaseFolders {
    /// Returns the working folder, the home folder of the user and the folder of the program.
    pub fn for_current_user() -> Self {
        let home = UserDirs::new().map(|own| own.home_dir().to_owned());
        let program = std::env::current_exe().ok().and_then(|path| Some(path.parent()?.to_owned()));
        BaseFolders { working: std::env::current_dir().ok(), home, program }
    }

    pub fn with_base_folders(working: &Path, home: &Path) -> Self {
        BaseFolders { working: Some(working.to_owned()), home: Some(home.to_owned()), program: None }
    }

    /// Returns these folders with another folder of the program.
    #[must_use]
    pub fn with_program_folder(self, program: &Path) -> Self {
        BaseFolders { program: Some(program.to_owned()), ..self }
    }

    /// Returns the folders in which the ready-made profiles may be. The first that exists has them.
    pub fn ready_made_profiles(&self) -> Vec<PathBuf> {
        /// Places of the profiles, and how many levels above the program they begin: the archive for Windows, the
        /// packages for Linux, the bundle for macOS, and a build from source.
        const PLACES: [(usize, &str); 4] =
            [(0, "profiles"), (1, "share/encoder-studio/profiles"), (1, "Resources/profiles"), (2, "profiles")];
        let place = |(levels, place)| Some(self.program.as_deref()?.ancestors().nth(levels)?.join(place));
        PLACES.into_iter().filter_map(place).collect()
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

    #[test]
    fn locates_ready_made_profile_folders() {
        let root = std::env::temp_dir();
        let expected = ["usr/bin/profiles", "usr/share/encoder-studio/profiles", "usr/Resources/profiles", "profiles"];
        let folders = BaseFolders::default().with_program_folder(&root.join("usr/bin"));
        assert_eq!(folders.ready_made_profiles(), expected.map(|path| root.join(path)));
        assert!(BaseFolders::default().ready_made_profiles().is_empty());
    }
}
