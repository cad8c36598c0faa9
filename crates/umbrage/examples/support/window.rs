//! A window that shows an example until it is closed.

use super::{Example, Gpu, Result, Target, gpu};
use std::sync::Arc;
use std::time::Instant;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowId};

/// Runs until the window is closed, or Escape is pressed.
pub fn run<E: Example>(size_px: [u32; 2], plain: bool) -> Result<()> {
    let no_window = |e| format!("no window can be opened: {e}; `--headless OUT.png` needs none");
    let event_loop = EventLoop::new().map_err(no_window)?;
    let mut app = App::<E> { size_px, plain, shown: None, failed: None };
    event_loop.run_app(&mut app).map_err(no_window)?;
    app.failed.map_or(Ok(()), Err)
}

struct App<E> {
    size_px: [u32; 2],
    plain: bool,
    shown: Option<Shown<E>>,
    failed: Option<Box<dyn std::error::Error>>,
}

struct Shown<E> {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    gpu: Gpu,
    example: E,
    since: Instant,
}

impl<E: Example> Shown<E> {
    fn new(event_loop: &ActiveEventLoop, size_px: [u32; 2], plain: bool) -> Result<Self> {
        let size = PhysicalSize::new(size_px[0], size_px[1]);
        let attributes = Window::default_attributes().with_title(E::NAME).with_inner_size(size);
        let window = Arc::new(event_loop.create_window(attributes)?);
        let instance = gpu::instance();
        let surface = instance.create_surface(window.clone())?;
        let (gpu, adapter) = Gpu::for_surface(&instance, Some(&surface))?;
        let PhysicalSize { width, height } = window.inner_size();
        let mut config = surface
            .get_default_config(&adapter, width.max(1), height.max(1))
            .ok_or("the adapter shows no pictures in windows; use `--headless OUT.png`")?;
        // Shaders write linear light.
        let formats = surface.get_capabilities(&adapter).formats;
        config.format = formats.into_iter().find(|format| format.is_srgb()).unwrap_or(config.format);
        surface.configure(&gpu.device, &config);
        let example = E::new(&gpu, config.format, plain)?;
        Ok(Self { window, surface, config, gpu, example, since: Instant::now() })
    }

    fn resize(&mut self, size: PhysicalSize<u32>) {
        // A minimised window has no size; what cannot be seen need not be drawn.
        if size.width > 0 && size.height > 0 {
            (self.config.width, self.config.height) = (size.width, size.height);
            self.surface.configure(&self.gpu.device, &self.config);
        }
    }

    fn draw(&mut self) -> Result<()> {
        use wgpu::CurrentSurfaceTexture as Current;
        let texture = match self.surface.get_current_texture() {
            Current::Success(texture) | Current::Suboptimal(texture) => texture,
            Current::Timeout | Current::Occluded => return self.gpu.check(),
            Current::Outdated | Current::Lost | Current::Validation => {
                self.surface.configure(&self.gpu.device, &self.config);
                return self.gpu.check();
            }
        };
        let view = texture.texture.create_view(&Default::default());
        let target = Target { view: &view, size_px: [self.config.width, self.config.height] };
        self.example.draw(&self.gpu, &target, self.since.elapsed().as_secs_f32())?;
        self.window.pre_present_notify();
        self.gpu.queue.present(texture);
        self.gpu.check()
    }
}

impl<E: Example> ApplicationHandler for App<E> {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        match Shown::new(event_loop, self.size_px, self.plain) {
            Ok(shown) => {
                shown.window.request_redraw();
                self.shown = Some(shown);
            }
            Err(why) => {
                self.failed = Some(why);
                event_loop.exit();
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(shown) = &mut self.shown else { return };
        match event {
            WindowEvent::CloseRequested => event_loop.exit(),
            WindowEvent::KeyboardInput { event, .. } if event.logical_key == Key::Named(NamedKey::Escape) => {
                event_loop.exit();
            }
            WindowEvent::Resized(size) => shown.resize(size),
            WindowEvent::RedrawRequested => {
                if let Err(why) = shown.draw() {
                    self.failed = Some(why);
                    event_loop.exit();
                }
                shown.window.request_redraw();
            }
            _ => {}
        }
    }
}
