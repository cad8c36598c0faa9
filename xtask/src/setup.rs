//! What the machine needs: a C++ compiler, something that speaks Vulkan, and for the tests a browser.
//!
//! On Debian and its kin, as root (a container, a build machine), what lacks is installed. Everywhere else we say what to
//! type: nobody wants a build to ask for a password.

use crate::process::{self, Done, Fault, failed};
use std::path::{Path, PathBuf};
use std::process::Command;

/// For what the machine is needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Any graphics adapter will do.
    Draw,
    /// Golden images compare on one rasteriser alone: lavapipe, Mesa's in software.
    Goldens,
    /// Golden images, and a browser in which the page of a report is opened.
    Tests,
}

/// Something that lacks, with its packages for each family of systems.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lack {
    Compiler,
    Vulkan,
    Browser,
}

/// A family of Linux systems that share a package manager.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Family {
    Debian,
    Fedora,
    Arch,
    Suse,
    Other,
}

/// Where loaders look for drivers.
const DRIVER_FOLDERS: [&str; 4] = [
    "/usr/share/vulkan/icd.d",
    "/etc/vulkan/icd.d",
    "/usr/local/share/vulkan/icd.d",
    "/run/opengl-driver/share/vulkan/icd.d",
];

/// What browsers are called that the tests can drive; those look for the same names.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

impl Lack {
    fn what(self) -> &'static str {
        match self {
            Self::Compiler => "a C and C++ compiler (the crate `meshopt` is C++)",
            Self::Vulkan => "a Vulkan driver and its loader",
            Self::Browser => "Chromium or Chrome for the tests (UMBRAGE_BROWSER may name one)",
        }
    }

    fn packages(self, family: Family) -> &'static [&'static str] {
        match (self, family) {
            (Self::Compiler, Family::Debian) => &["build-essential"],
            (Self::Compiler, Family::Arch) => &["base-devel"],
            (Self::Compiler, Family::Fedora | Family::Suse) => &["gcc", "gcc-c++"],
            (Self::Compiler, Family::Other) => &["gcc", "g++"],
            (Self::Vulkan, Family::Debian) => &["mesa-vulkan-drivers", "libvulkan1"],
            (Self::Vulkan, Family::Fedora) => &["mesa-vulkan-drivers", "vulkan-loader"],
            (Self::Vulkan, Family::Arch) => &["vulkan-swrast", "vulkan-icd-loader"],
            (Self::Vulkan, Family::Suse) => &["libvulkan_lvp", "libvulkan1"],
            (Self::Vulkan, Family::Other) => &["Mesa's lavapipe", "the Vulkan loader (libvulkan.so.1)"],
            (Self::Browser, Family::Other) => &["Chromium"],
            (Self::Browser, _) => &["chromium"],
        }
    }
}

impl Family {
    /// From the text of `/etc/os-release`.
    fn of(os_release: &str) -> Self {
        let values = |key: &str| {
            let line = os_release.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix('='));
            line.unwrap_or("").trim_matches('"').to_lowercase()
        };
        let names = format!("{} {}", values("ID"), values("ID_LIKE"));
        let has = |known: &[&str]| names.split_whitespace().any(|n| known.iter().any(|k| n.starts_with(k)));
        if has(&["debian", "ubuntu"]) {
            Self::Debian
        } else if has(&["fedora", "rhel", "centos"]) {
            Self::Fedora
        } else if has(&["arch"]) {
            Self::Arch
        } else if has(&["suse", "opensuse"]) {
            Self::Suse
        } else {
            Self::Other
        }
    }

    fn here() -> Self {
        Self::of(&std::fs::read_to_string("/etc/os-release").unwrap_or_default())
    }

    fn command(self) -> &'static str {
        match self {
            Self::Debian => "sudo apt-get install -y --no-install-recommends ",
            Self::Fedora => "sudo dnf install ",
            Self::Arch => "sudo pacman -S ",
            Self::Suse => "sudo zypper install ",
            Self::Other => "",
        }
    }
}

/// `cargo xtask setup`
pub fn run(_: &[String]) -> Done {
    before_build(Need::Tests)?;
    process::build_umbrage("debug")?;
    after_build()?;
    println!("This machine has all that Umbrage needs. `umbrage doctor` says what it can do.");
    Ok(())
}

/// What can be seen to lack without a build; installs it where we may.
pub fn before_build(need: Need) -> Done {
    if cfg!(windows) {
        // Rust itself needs Microsoft's compiler there, and Direct3D 12 is part of the system.
        return Ok(());
    }
    let lacking = lacking(need);
    if lacking.is_empty() {
        return Ok(());
    }
    if cfg!(target_os = "macos") {
        return Err(failed("a C++ compiler is needed; type `xcode-select --install`"));
    }
    provide(&lacking)?;
    if self::lacking(need).is_empty() {
        Ok(())
    } else {
        Err(failed(format!("after the installation there still lacks {}", names(&lacking))))
    }
}

/// Asks the built command whether it can draw. A driver's file may be there and its graphics card not.
pub fn after_build() -> Done {
    let doctor = || process::output(&mut process::umbrage("debug", ["doctor"]));
    let said = doctor()?;
    if said.status.success() {
        return Ok(());
    }
    if cfg!(target_os = "linux") {
        eprintln!("no driver that is installed finds an adapter: {}", process::last_words(&said));
        provide(&[Lack::Vulkan])?;
        if doctor()?.status.success() {
            return Ok(());
        }
    }
    Err(failed(format!("no graphics adapter can be used: {}", process::last_words(&said))))
}

fn lacking(need: Need) -> Vec<Lack> {
    let mut lacking = Vec::new();
    let compilers = [("CC", "cc"), ("CXX", "c++")];
    let has = |(variable, usual): (&str, &str)| {
        // A variable may hold arguments, or a wrapper before the compiler: it is the user's word that there is one.
        std::env::var_os(variable).is_some() || process::is_installed(usual)
    };
    if !compilers.into_iter().all(has) {
        lacking.push(Lack::Compiler);
    }
    if cfg!(target_os = "linux") && !(has_driver(need) && has_loader()) {
        lacking.push(Lack::Vulkan);
    }
    if cfg!(target_os = "linux") && need == Need::Tests && !has_browser() {
        lacking.push(Lack::Browser);
    }
    lacking
}

fn has_browser() -> bool {
    // As with compilers, a variable is the user's word; the tests say so when nothing is there.
    let named = std::env::var_os("UMBRAGE_BROWSER").is_some_and(|name| !name.is_empty());
    named || BROWSERS.into_iter().any(process::is_installed)
}

/// Files that describe Vulkan drivers.
fn drivers() -> Vec<PathBuf> {
    // Where one of these is set, the loader looks nowhere else.
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        if let Some(files) = std::env::var_os(variable) {
            return std::env::split_paths(&files).filter(|file| file.exists()).collect();
        }
    }
    let files = |folder: &&str| std::fs::read_dir(folder).into_iter().flatten().flatten();
    let files = DRIVER_FOLDERS.iter().flat_map(files).map(|entry| entry.path());
    files.filter(|file| file.extension().is_some_and(|e| e == "json")).collect()
}

fn has_driver(need: Need) -> bool {
    let fits = |file: &PathBuf| need == Need::Draw || is_lavapipe(file);
    drivers().iter().any(fits)
}

fn is_lavapipe(file: &Path) -> bool {
    let named = |text: &str| text.contains("lvp") || text.contains("lavapipe");
    let name = file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    named(&name) || std::fs::read_to_string(file).is_ok_and(|text| named(&text))
}

fn has_loader() -> bool {
    let list = |program: &str| Command::new(program).arg("-p").output().ok().filter(|o| o.status.success());
    // Not in everybody's path. Where there is none at all (musl, Nix), `umbrage doctor` finds out after the build.
    let lists = ["ldconfig", "/sbin/ldconfig", "/usr/sbin/ldconfig"].iter().find_map(|p| list(p));
    lists.is_none_or(|o| String::from_utf8_lossy(&o.stdout).contains("libvulkan.so.1"))
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|o| String::from_utf8_lossy(&o.stdout).trim() == "0")
}

fn names(lacking: &[Lack]) -> String {
    lacking.iter().map(|lack| lack.what()).collect::<Vec<_>>().join(", and ")
}

fn packages(lacking: &[Lack], family: Family) -> Vec<&'static str> {
    lacking.iter().flat_map(|lack| lack.packages(family)).copied().collect()
}

/// What to type, for those who must do it themselves.
fn advice(lacking: &[Lack], family: Family) -> String {
    let verb = if family == Family::Other { "install" } else { "type" };
    let packages = packages(lacking, family);
    let words = match family {
        Family::Other => packages.join(", "),
        _ => format!("`{}{}`", family.command(), packages.join(" ")),
    };
    format!("this machine lacks {}; {verb} {words}, then try again", names(lacking))
}

/// Installs, on Debian as root; says what to install everywhere else.
fn provide(lacking: &[Lack]) -> Result<(), Fault> {
    let family = Family::here();
    if family != Family::Debian || !is_root() || !process::is_installed("apt-get") {
        return Err(failed(advice(lacking, family)));
    }
    let packages = packages(lacking, family);
    eprintln!("this machine lacks {}: installing {}", names(lacking), packages.join(", "));
    let apt = |arguments: &[&str]| {
        let mut command = Command::new("apt-get");
        command.args(arguments).env("DEBIAN_FRONTEND", "noninteractive");
        process::run(&mut command)
    };
    apt(&["update"])?;
    let mut install = vec!["install", "-y", "--no-install-recommends"];
    install.extend(packages);
    match apt(&install) {
        // Ubuntu has it as a snap alone, which no container runs.
        Err(Fault::Failed(why)) if lacking.contains(&Lack::Browser) => Err(failed(format!(
            "{why}; where apt-get has no chromium (Ubuntu), install Google Chrome or name a browser in UMBRAGE_BROWSER"
        ))),
        done => done,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_are_told_by_what_they_are_like() {
        for (text, family) in [
            ("PRETTY_NAME=\"Debian GNU/Linux 12\"\nID=debian\n", Family::Debian),
            ("ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n", Family::Debian),
            ("ID=\"rocky\"\nID_LIKE=\"rhel centos fedora\"\n", Family::Fedora),
            ("ID=arch\n", Family::Arch),
            ("ID=\"opensuse-tumbleweed\"\nID_LIKE=\"opensuse suse\"\n", Family::Suse),
            ("VERSION_ID=debian\nID=alpine\n", Family::Other),
            ("", Family::Other),
        ] {
            assert_eq!(Family::of(text), family, "{text}");
        }
    }

    #[test]
    fn advice_is_one_line_that_can_be_typed() {
        let all = [Lack::Compiler, Lack::Vulkan, Lack::Browser];
        let debian = advice(&all, Family::Debian);
        assert!(debian.contains("build-essential mesa-vulkan-drivers libvulkan1 chromium`"), "{debian}");
        for family in [Family::Debian, Family::Fedora, Family::Arch, Family::Suse, Family::Other] {
            assert_eq!(advice(&all, family).lines().count(), 1);
            let browser = advice(&[Lack::Browser], family);
            let words = match family {
                Family::Other => "install Chromium,".to_owned(),
                _ => format!("type `{}chromium`,", family.command()),
            };
            assert!(browser.contains(&words), "{browser}");
        }
    }

    #[test]
    fn only_tests_need_a_browser_and_they_look_for_the_same() {
        for need in [Need::Draw, Need::Goldens] {
            assert!(!lacking(need).contains(&Lack::Browser), "{need:?}");
        }
        let client = process::root().join("crates/umbrage-cli/tests/browser/mod.rs");
        let client = std::fs::read_to_string(client).expect("what drives the browser");
        assert!(client.contains(&format!(" = {BROWSERS:?};")), "{BROWSERS:?} are not the names there");
    }

    #[test]
    fn lavapipe_is_told_from_other_drivers() {
        assert!(is_lavapipe(Path::new("/nowhere/lvp_icd.x86_64.json")));
        assert!(!is_lavapipe(Path::new("/nowhere/radeon_icd.x86_64.json")));
    }
}
