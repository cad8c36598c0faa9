//! `umbrage doctor`: what this machine has, what would be chosen, what is missing.

use crate::args::DoctorArgs;
use crate::fault::{Fault, say};
use crate::json::{self, Machine, MapFormat};
use crate::text;
use serde::Serialize;
use umbrage_render::umbrage::caster::unclipped;
use umbrage_render::umbrage::core::technique::Storage;
use umbrage_render::umbrage::format::{BY_PRECISION, choose_format, format_of, lacks};
use umbrage_render::umbrage::volume::choose_count_format;
use umbrage_render::{Gpu, gpu};

#[derive(Serialize)]
struct Report {
    adapters: Vec<Adapter>,
    chosen: String,
    why: String,
    #[serde(flatten)]
    machine: Machine,
    limits: Limits,
    timestamps: bool,
    statistics: bool,
    formats: Vec<Format>,
    auto_format: Option<MapFormat>,
    auto_objection: Option<String>,
    samples: Vec<u32>,
    volumes: Volumes,
    missing: Vec<String>,
}

#[derive(Serialize)]
struct Adapter {
    #[serde(flatten)]
    machine: Machine,
    kind: String,
    chosen: bool,
}

/// What stencil volumes are counted with.
#[derive(Serialize)]
struct Volumes {
    format: &'static str,
    depth_clip_control: bool,
}

#[derive(Serialize)]
struct Limits {
    texture_size: u32,
    texture_layers: u32,
    sampled_textures: u32,
    bind_groups: u32,
    buffer_bytes: u64,
}

#[derive(Serialize)]
struct Format {
    storage: &'static str,
    usable: bool,
    lacks: Option<&'static str>,
    about: &'static str,
}

/// Looks and reports.
///
/// # Errors
/// [`Fault::Failed`] when there is no adapter, with what to install.
pub fn run(args: &DoctorArgs) -> Result<(), Fault> {
    let gpu = Gpu::new(args.adapter.as_deref())?;
    let report = examine(&gpu, args.adapter.as_deref());
    if args.json { json::print(&report) } else { say(&describe(&report)) }
}

fn examine(gpu: &Gpu, asked: Option<&str>) -> Report {
    let infos: Vec<wgpu::AdapterInfo> = gpu::adapters().iter().map(wgpu::Adapter::get_info).collect();
    let chosen = infos.iter().position(|info| *info == gpu.info);
    let adapters = infos
        .iter()
        .enumerate()
        .map(|(i, info)| Adapter {
            machine: Machine::of(info),
            kind: kind(info.device_type).to_owned(),
            chosen: Some(i) == chosen,
        })
        .collect();
    let why = match asked {
        Some(name) => format!("its name contains `{name}`"),
        None if infos.len() < 2 => "it is the only one".to_owned(),
        None => format!(
            "the first {} one; discrete is preferred to integrated, virtual, software",
            kind(gpu.info.device_type)
        ),
    };
    let limits = gpu.device.limits();
    let auto = choose_format(Storage::Auto, |format| gpu.usages_of(format));
    let samples = gpu.adapter.get_texture_format_features(wgpu::TextureFormat::Rgba8UnormSrgb).flags;
    Report {
        adapters,
        chosen: gpu.info.name.clone(),
        why,
        machine: Machine::of(&gpu.info),
        limits: Limits {
            texture_size: limits.max_texture_dimension_2d,
            texture_layers: limits.max_texture_array_layers,
            sampled_textures: limits.max_sampled_textures_per_shader_stage,
            bind_groups: limits.max_bind_groups,
            buffer_bytes: limits.max_buffer_size,
        },
        timestamps: gpu.has_timestamps(),
        statistics: gpu.has_statistics(),
        formats: BY_PRECISION.iter().map(|storage| format_of_adapter(gpu, *storage)).collect(),
        auto_format: auto.as_ref().ok().map(MapFormat::of),
        auto_objection: auto.err().map(|e| e.to_string()),
        samples: samples
            .supported_sample_counts()
            .into_iter()
            .filter(|count| matches!(count, 1 | 4))
            .collect(),
        volumes: Volumes {
            format: match choose_count_format(&gpu.device) {
                wgpu::TextureFormat::Depth32FloatStencil8 => "depth32float-stencil8",
                _ => "depth24plus-stencil8, because the adapter lacks DEPTH32FLOAT_STENCIL8",
            },
            depth_clip_control: unclipped(&gpu.device),
        },
        missing: missing(gpu),
    }
}

fn format_of_adapter(gpu: &Gpu, storage: Storage) -> Format {
    let lacks = format_of(storage).and_then(|format| lacks(gpu.usages_of(format)));
    let about = match storage {
        Storage::Depth24 => "WebGPU's depth24plus: 24 bits, or 32-bit float underneath, as the adapter likes",
        Storage::Depth16 => "16-bit normalised",
        Storage::R32Float => "distance in a 32-bit float colour target",
        Storage::Packed1 | Storage::Packed2 | Storage::Packed3 => "distance in channels of 8 bits",
        Storage::Auto | Storage::Depth32Float => "32-bit float",
    };
    Format { storage: storage.row().id, usable: lacks.is_none(), lacks, about }
}

fn kind(kind: wgpu::DeviceType) -> &'static str {
    match kind {
        wgpu::DeviceType::DiscreteGpu => "discrete",
        wgpu::DeviceType::IntegratedGpu => "integrated",
        wgpu::DeviceType::VirtualGpu => "virtual",
        wgpu::DeviceType::Cpu => "software",
        wgpu::DeviceType::Other => "other",
    }
}

fn missing(gpu: &Gpu) -> Vec<String> {
    let mut missing = Vec::new();
    if gpu.info.device_type == wgpu::DeviceType::Cpu {
        missing.push(
            "a hardware adapter: pictures are right but slow, and times say nothing of a graphics card; with a card \
             in this machine, install its vendor's Vulkan driver"
                .to_owned(),
        );
    }
    if !gpu.has_timestamps() {
        missing.push(
            "time stamps: gpu_ms stays empty, frame times are still measured; a newer driver may have them"
                .to_owned(),
        );
    }
    if !gpu.has_statistics() {
        missing.push(
            "pipeline statistics: vertex and fragment runs stay empty; a newer driver may have them"
                .to_owned(),
        );
    }
    missing
}

fn describe(report: &Report) -> String {
    const INDENT: usize = 14;
    let width = text::width();
    let line = |head: &str, text: &str| text::hang(head, INDENT, text, width);
    let yes = |is: bool| if is { "yes" } else { "no" };
    let mut out = String::from("Adapters\n");
    for adapter in &report.adapters {
        let mark = if adapter.chosen { "  * " } else { "    " };
        out += &text::hang(
            mark,
            4,
            &format!("{} ({}, {})", adapter.machine.adapter, adapter.kind, adapter.machine.backend),
            width,
        );
    }
    out += "\n";
    out += &line("Chosen", &format!("{}: {}", report.chosen, report.why));
    out += &line("Driver", &report.machine.driver);
    out += &line("Backend", &report.machine.backend);
    let limits = &report.limits;
    out += &line(
        "Limits",
        &format!(
            "pictures and maps up to {0}x{0}, {1} layers, {2} sampled textures, {3} bind groups, buffers up to {4}",
            limits.texture_size,
            limits.texture_layers,
            limits.sampled_textures,
            limits.bind_groups,
            text::bytes(limits.buffer_bytes)
        ),
    );
    out += &line(
        "Measuring",
        &format!("time stamps: {}; pipeline statistics: {}", yes(report.timestamps), yes(report.statistics)),
    );
    let samples: Vec<String> = report.samples.iter().map(u32::to_string).collect();
    out += &line("MSAA", &format!("{} samples a pixel", samples.join(" or ")));
    let clipped = if report.volumes.depth_clip_control {
        "a far plane cuts none (DEPTH_CLIP_CONTROL)"
    } else {
        "the picture has no far plane with them, because the adapter lacks DEPTH_CLIP_CONTROL"
    };
    out += &line("Volumes", &format!("counted over {}; {clipped}", report.volumes.format));
    out += "\nFormats of shadow maps, best first\n";
    for format in &report.formats {
        let verdict = format.lacks.map_or_else(|| "usable".to_owned(), |lacks| format!("lacks {lacks}"));
        out += &line(&format!("  {}", format.storage), &format!("{verdict} ({})", format.about));
    }
    out += &match (&report.auto_format, &report.auto_objection) {
        (Some(auto), _) => line("  auto", &format!("takes {}: {}", auto.storage, auto.why)),
        (None, objection) => line("  auto", objection.as_deref().unwrap_or("nothing")),
    };
    out += if report.missing.is_empty() { "\nNothing is missing.\n" } else { "\nMissing\n" };
    for missing in &report.missing {
        out += &text::hang("  - ", 4, missing, width);
    }
    out
}
