//! Writes the man pages and the completions for shells, as packages contain them, into a folder. They are made from the
//! definition of the command line, so that they cannot differ from it.
//!
//!     cargo run --example manual -- FOLDER

use std::fs;
use std::io;
use std::path::PathBuf;

use clap_complete::Shell;
use encoder_studio::cli;
use encoder_studio::kinds::program;

fn main() -> io::Result<()> {
    let Some(folder) = std::env::args_os().nth(1).map(PathBuf::from) else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "Name the folder to write to."));
    };
    fs::create_dir_all(&folder)?;
    let command = || cli::command(program().commands);
    for shell in [Shell::Bash, Shell::Fish, Shell::Zsh] {
        clap_complete::generate_to(shell, &mut command(), "encoder-studio", &folder)?;
    }
    // clap_complete 4.6 spells the hyphen of the program's name in two ways, so that nothing is completed after a command
    // (https://github.com/clap-rs/clap/issues/6421).
    let bash = folder.join("encoder-studio.bash");
    let script = fs::read_to_string(&bash)?.replace("encoder__subcmd__studio", "encoder__studio");
    fs::write(bash, script)?;
    // Each command has a page. `help` and its arguments would be as many again.
    let without_help = command().disable_help_subcommand(true);
    clap_mangen::generate_to(without_help.mut_subcommands(|own| own.disable_help_subcommand(true)), &folder)
}
