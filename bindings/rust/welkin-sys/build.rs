//! Links an installed Welkin that pkg-config finds, or else builds `welkin::core` from the sources with CMake.
//! `WELKIN_SOURCE` names the source tree; if it is set, no installed library is looked for. Without it, the core's sources
//! in this package are built (`bindings/rust/package` puts them there), or the tree that contains this crate.
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn main() {
    for name in ["WELKIN_SOURCE", "PKG_CONFIG", "PKG_CONFIG_PATH", "PKG_CONFIG_LIBDIR"] {
        println!("cargo:rerun-if-env-changed={name}");
    }
    let files = env::var_os("CARGO_FEATURE_FILES").is_some();
    if env::var_os("WELKIN_SOURCE").is_none() && link_installed(if files { "welkin" } else { "welkin-core" }) {
        return;
    }
    if files {
        panic!("the feature `files` needs an installed Welkin: set PKG_CONFIG_PATH to the folder of welkin.pc");
    }
    let manifest = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap());
    let places = [manifest.join("core"), manifest.join("../../..")];
    let inside = places.iter().find(|place| place.join("third_party.cmake").exists()).unwrap_or(&places[1]);
    let source = env::var_os("WELKIN_SOURCE").map_or_else(|| inside.clone(), PathBuf::from);
    if !source.join("third_party.cmake").exists() {
        panic!(
            "pkg-config finds no welkin-core 0.2, and {} is not Welkin's source tree: install Welkin, or set WELKIN_SOURCE",
            source.display()
        );
    }
    build_core(&source);
}

/// Passes what pkg-config prints to the linker. Returns false if there is no such module.
fn link_installed(module: &str) -> bool {
    let program = env::var_os("PKG_CONFIG").unwrap_or_else(|| "pkg-config".into());
    let wanted = format!("{module} >= 0.2");
    let output = match Command::new(program).args(["--libs", "--keep-system-libs", &wanted]).output() {
        Ok(output) if output.status.success() => output,
        _ => return false,
    };
    for word in String::from_utf8_lossy(&output.stdout).split_whitespace() {
        if let Some(folder) = word.strip_prefix("-L") {
            println!("cargo:rustc-link-search=native={folder}");
        } else if let Some(library) = word.strip_prefix("-l") {
            println!("cargo:rustc-link-lib={library}");
        }
    }
    true
}

/// Builds the static library of the preset `core` in `OUT_DIR`, and links it with oneTBB and C++'s library.
fn build_core(source: &Path) {
    let build = PathBuf::from(env::var_os("OUT_DIR").unwrap()).join("core");
    fs::create_dir_all(&build).unwrap();
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(source).arg("-B").arg(&build).arg("-DCMAKE_BUILD_TYPE=Release");
    configure.arg(format!("-DCMAKE_ARCHIVE_OUTPUT_DIRECTORY={}", build.join("lib").display()));
    configure.args(["-DBUILD_SHARED_LIBS=OFF", "-DCMAKE_POSITION_INDEPENDENT_CODE=ON", "-DWELKIN_LIBRARY_TOGETHER=ON"]);
    for part in ["FILES", "TESTS", "PERF", "TOOLS", "EXAMPLES", "INSTALL"] {
        configure.arg(format!("-DWELKIN_{part}=OFF"));
    }
    run(&mut configure);
    let jobs = env::var("NUM_JOBS").unwrap_or_else(|_| "1".into());
    run(Command::new("cmake").arg("--build").arg(&build).args(["--target", "welkin_core", "-j", &jobs]));
    for folder in ["module", "include", "cmake", "CMakeLists.txt", "third_party.cmake"] {
        println!("cargo:rerun-if-changed={}", source.join(folder).display());
    }
    println!("cargo:rustc-link-search=native={}", build.join("lib").display());
    println!("cargo:rustc-link-lib=static=welkin-core");
    println!("cargo:rustc-link-lib=tbb");
    let system = env::var("CARGO_CFG_TARGET_OS").unwrap();
    println!("cargo:rustc-link-lib={}", if system == "macos" { "c++" } else { "stdc++" });
}

fn run(command: &mut Command) {
    match command.status() {
        Ok(status) if status.success() => {}
        Ok(status) => panic!("{command:?} failed: {status}"),
        Err(error) => panic!("cannot run {command:?}: {error}"),
    }
}
