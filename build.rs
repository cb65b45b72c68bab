//! Build script: icon, version and manifest of the executable for Windows. On other systems it does nothing.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=assets/icon/encoder-studio.ico");
    println!("cargo::rerun-if-changed=assets/windows/encoder-studio.manifest");
    if env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "windows") {
        let compiled = winresource::WindowsResource::new()
            .set_icon("assets/icon/encoder-studio.ico")
            .set_manifest_file("assets/windows/encoder-studio.manifest")
            .set("LegalCopyright", "MIT OR Apache-2.0")
            .compile_for("encoder-studio");
        // The program also works without an icon.
        if let Err(error) = compiled {
            println!("cargo::warning=The executable has no icon, version and manifest: {error}");
        }
    }
}
