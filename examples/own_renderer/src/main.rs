//! `own_renderer --headless OUT.png`: one picture, without a window.

use std::error::Error;
use std::process::ExitCode;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [flag, path] = args.as_slice() else { return wrong_use() };
    if flag != "--headless" {
        return wrong_use();
    }
    match picture(path) {
        Ok(adapter) => {
            println!("{path} is drawn by {adapter}");
            ExitCode::SUCCESS
        }
        Err(why) => {
            eprintln!("own_renderer: {why}");
            ExitCode::FAILURE
        }
    }
}

fn wrong_use() -> ExitCode {
    eprintln!("own_renderer: it has no window; use `own_renderer --headless OUT.png`");
    ExitCode::from(2)
}

fn picture(path: &str) -> Result<String, Box<dyn Error>> {
    let gpu = own_renderer::open(None)?;
    let (width, height) = (960, 640);
    let rgba = own_renderer::draw(&gpu, width, height, true)?;
    image::save_buffer(path, &rgba, width, height, image::ColorType::Rgba8)
        .map_err(|e| format!("{path} cannot be written: {e}"))?;
    Ok(gpu.name)
}
