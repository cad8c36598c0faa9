//! What the examples share: a device, a window or a picture, shapes. None of it is about shadows.
#![allow(dead_code, reason = "each example uses a part of it")]

pub mod forward;
pub mod gpu;
pub mod picture;
pub mod shapes;
mod window;

pub use gpu::Gpu;
pub use picture::picture;
use std::process::ExitCode;

/// Errors are one line each, which says what to do.
pub type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Where a frame is drawn.
pub struct Target<'a> {
    pub view: &'a wgpu::TextureView,
    pub size_px: [u32; 2],
}

impl Target<'_> {
    pub fn aspect(&self) -> f32 {
        self.size_px[0] as f32 / self.size_px[1] as f32
    }
}

/// One example.
pub trait Example: Sized {
    /// As `cargo run --example` knows it.
    const NAME: &'static str;
    /// What `--time` is when it is not given, seconds.
    const TIME_S: f32 = 0.0;

    /// What is drawn for a picture of `time_s`, one after the other.
    fn times_s(time_s: f32) -> Vec<f32> {
        vec![time_s]
    }

    /// Pictures will have `format`. `plain`: without what the example is about, to see the difference.
    fn new(gpu: &Gpu, format: wgpu::TextureFormat, plain: bool) -> Result<Self>;

    /// Draws a moment and submits it.
    fn draw(&mut self, gpu: &Gpu, target: &Target<'_>, time_s: f32) -> Result<()>;

    /// What a picture's maker may want to know of the frames.
    fn report(&self) -> String {
        String::new()
    }
}

/// The command line.
struct Arguments {
    headless: Option<String>,
    size_px: [u32; 2],
    time_s: Option<f32>,
    plain: bool,
}

fn parse(mut words: impl Iterator<Item = String>) -> std::result::Result<Arguments, String> {
    let mut parsed = Arguments { headless: None, size_px: [960, 640], time_s: None, plain: false };
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("`{word}` needs a value"));
        match word.as_str() {
            "--headless" => parsed.headless = Some(value()?),
            "--size" => {
                let value = value()?;
                let both = value.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
                let fits = |both: &[u32; 2]| both.iter().all(|side| (1..=8192).contains(side));
                parsed.size_px =
                    both.filter(fits).ok_or(format!("`--size {value}`: it is WxH, 1x1 to 8192x8192"))?;
            }
            "--time" => {
                let value = value()?;
                let seconds = value.parse().ok().filter(|s: &f32| (0.0..=1e5).contains(s));
                parsed.time_s = Some(seconds.ok_or(format!("`--time {value}`: it is seconds, 0 to 100000"))?);
            }
            "--plain" => parsed.plain = true,
            _ => return Err(format!("`{word}` is no option")),
        }
    }
    if parsed.headless.is_none() && parsed.time_s.is_some() {
        return Err("`--time` goes with `--headless`".to_owned());
    }
    Ok(parsed)
}

/// Does what the command line asks for.
pub fn run<E: Example>() -> ExitCode {
    let name = E::NAME;
    let arguments = match parse(std::env::args().skip(1)) {
        Ok(arguments) => arguments,
        Err(why) => {
            eprintln!("{name}: {why}; use: {name} [--headless OUT.png [--time S]] [--size WxH] [--plain]");
            return ExitCode::from(2);
        }
    };
    let done = match &arguments.headless {
        Some(path) => headless::<E>(path, &arguments),
        None => window::run::<E>(arguments.size_px, arguments.plain),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{name}: {why}");
            ExitCode::FAILURE
        }
    }
}

fn headless<E: Example>(path: &str, arguments: &Arguments) -> Result<()> {
    let gpu = Gpu::open(None)?;
    let size_px = arguments.size_px;
    let time_s = arguments.time_s.unwrap_or(E::TIME_S);
    let (rgba, report) = picture::<E>(&gpu, size_px, arguments.plain, &E::times_s(time_s))?;
    image::save_buffer(path, &rgba, size_px[0], size_px[1], image::ColorType::Rgba8)
        .map_err(|e| format!("{path} cannot be written: {e}"))?;
    println!("{path} is drawn by {}", gpu.adapter_name);
    if !report.is_empty() {
        println!("{report}");
    }
    Ok(())
}
