//! Which machine a number was measured on.

use std::process::Command;

/// The processor's name and how many cores this process may use.
pub fn processor() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{}, {cores} core{}", model(), if cores == 1 { "" } else { "s" })
}

fn model() -> String {
    let from_linux = || model_in(&std::fs::read_to_string("/proc/cpuinfo").ok()?);
    let from_mac = || {
        let said = Command::new("sysctl").args(["-n", "machdep.cpu.brand_string"]).output().ok()?;
        Some(String::from_utf8_lossy(&said.stdout).trim().to_owned()).filter(|name| !name.is_empty())
    };
    let from_windows = || std::env::var("PROCESSOR_IDENTIFIER").ok();
    from_linux().or_else(from_mac).or_else(from_windows).unwrap_or_else(|| "unknown processor".to_owned())
}

fn model_in(cpuinfo: &str) -> Option<String> {
    let value = |key: &str| {
        let line = cpuinfo.lines().find(|line| line.starts_with(key))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    value("model name")
        .or_else(|| value("Model"))
        .or_else(|| value("CPU part").map(|p| format!("ARM part {p}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_model_is_read_from_either_kind_of_list() {
        assert_eq!(
            model_in("processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\n").as_deref(),
            Some("Some CPU @ 2 GHz")
        );
        assert_eq!(model_in("processor\t: 0\nCPU part\t: 0xd0c\n").as_deref(), Some("ARM part 0xd0c"));
        assert_eq!(model_in(""), None);
    }
}
