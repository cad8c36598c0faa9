//! V that is found on the screen: its texture, and the volumes that are counted for it over the caller's depth.

use super::casters::Casters;
use super::handles::{Store, index};
use super::lights::Lit;
use super::meshes::Mesh;
use super::{Frame, ShadowsError, depth};
use crate::layers::Layers;
use crate::volume::{ScreenVolumes, VolumeEye, VolumeItem, choose_count_format};
use glam::Vec3;
use umbrage_core::{Aabb, DepthConvention};

/// V on the screen: 8 bits a light and pixel.
pub(super) const V: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// A mesh's triangles, until volumes are made of them.
type Shape = (usize, Vec<Vec3>, Vec<u32>);

/// V of lights that have it on the screen.
#[derive(Debug)]
pub(super) struct Screen {
    pub v: Layers,
    size_px: [u32; 2],
    /// Lights on the screen.
    pub count: u32,
    /// Format of the depth that is counted over.
    pub depth_format: wgpu::TextureFormat,
    /// Which way that runs, once a frame has said so.
    pub convention: Option<DepthConvention>,
    pub volumes: Option<ScreenVolumes>,
    shapes: Vec<Shape>,
    /// The depth that was found to be usable, and the same to be read.
    pub checked: Option<(wgpu::TextureView, Option<wgpu::TextureView>)>,
}

fn make(device: &wgpu::Device, size_px: [u32; 2], count: u32) -> Layers {
    Layers::new(device, "umbrage visibility", size_px, count.max(1), V)
}

impl Screen {
    /// V of a pixel, until there is a frame.
    pub fn new(device: &wgpu::Device, depth_format: Option<wgpu::TextureFormat>) -> Self {
        Self {
            v: make(device, [1, 1], 1),
            size_px: [1, 1],
            count: 0,
            depth_format: depth_format.unwrap_or_else(|| choose_count_format(device)),
            convention: None,
            volumes: None,
            shapes: Vec::new(),
            checked: None,
        }
    }

    /// Keeps a mesh's triangles.
    pub fn set_shape(
        &mut self,
        number: usize,
        positions: &[Vec3],
        indices: &[u32],
    ) -> Result<(), ShadowsError> {
        match &mut self.volumes {
            Some(volumes) => Ok(volumes.set_mesh(number, positions, indices)?),
            None => {
                self.shapes.retain(|(other, ..)| *other != number);
                self.shapes.push((number, positions.to_vec(), indices.to_vec()));
                Ok(())
            }
        }
    }

    /// Forgets a mesh's triangles.
    pub fn remove_shape(&mut self, number: usize) {
        self.shapes.retain(|(other, ..)| *other != number);
        if let Some(volumes) = &mut self.volumes {
            volumes.remove_mesh(number);
        }
    }

    /// V for so many lights in a frame; true when its texture is another one now.
    pub fn make_room(
        &mut self,
        device: &wgpu::Device,
        frame: &Frame,
        count: u32,
    ) -> Result<bool, ShadowsError> {
        let convention = *self.convention.get_or_insert(frame.depth);
        if convention != frame.depth {
            return Err(ShadowsError::Number {
                what: "frame's depth",
                value: format!("{:?}", frame.depth),
                allowed: "as it was in the first frame: one `Shadows` has one depth",
            });
        }
        let limits = device.limits();
        let (width, height) = (frame.size_px.x, frame.size_px.y);
        if width.max(height) > limits.max_texture_dimension_2d {
            return Err(ShadowsError::Limit {
                limit: "max_texture_dimension_2d",
                has: u64::from(limits.max_texture_dimension_2d),
                needed: u64::from(width.max(height)),
                advice: "draw a smaller picture",
            });
        }
        self.count = count;
        let has = self.v.count();
        if self.size_px == [width, height] && count <= has {
            return Ok(false);
        }
        self.size_px = [width, height];
        self.v = make(device, self.size_px, count.max(has));
        Ok(true)
    }

    /// Tells volumes what there is.
    pub fn tell(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        frame: &Frame,
        lights: &Store<Lit>,
        meshes: &Store<Mesh>,
        casters: &Casters,
        scene_world: &Aabb,
    ) -> Result<(), ShadowsError> {
        let has_volumes = lights.iter().any(|(_, lit)| lit.volume.is_some());
        if has_volumes && self.volumes.is_none() {
            let mut made = ScreenVolumes::new(device, queue, self.depth_format, frame.depth, V)?;
            for (number, positions, indices) in self.shapes.drain(..) {
                made.set_mesh(number, &positions, &indices)?;
            }
            self.volumes = Some(made);
        }
        // Without any light the ones that were told before are forgotten.
        let Some(volumes) = &mut self.volumes else { return Ok(()) };
        volumes.begin(&VolumeEye {
            clip_from_world: frame.clip_from_world(),
            clip_from_view: frame.clip_from_view,
            size_px: frame.size_px,
            is_parallel: frame.is_parallel(),
        });
        for (key, lit) in lights.iter() {
            let Some(settings) = &lit.volume else { continue };
            let items = casters.all.iter().filter_map(|(_, caster)| {
                let mesh = caster.mesh?;
                meshes.at(mesh.key).filter(|mesh| mesh.makes_volumes())?;
                Some(VolumeItem {
                    mesh: index(mesh.key),
                    world_from_object: caster.world_from_object,
                    bounds_world: caster.bounds_world,
                })
            });
            volumes.tell(index(key), &lit.light, settings, scene_world, items);
        }
        Ok(())
    }

    /// Checks the caller's depth, and makes what reads it; no cost while it is the same.
    pub fn check(
        &mut self,
        device: &wgpu::Device,
        view: &wgpu::TextureView,
        is_read: bool,
    ) -> Result<(), ShadowsError> {
        if self.checked.as_ref().is_some_and(|(known, read)| known == view && (read.is_some() || !is_read)) {
            return Ok(());
        }
        let texture = view.texture();
        if texture.format() != self.depth_format {
            return Err(ShadowsError::DepthFormat { has: texture.format(), wanted: self.depth_format });
        }
        depth::check(device, view, self.size_px, is_read)?;
        let read = is_read.then(|| depth::readable(view));
        self.checked = Some((view.clone(), read));
        Ok(())
    }

    /// Memory, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.v.memory_bytes() + self.volumes.as_ref().map_or(0, ScreenVolumes::memory_bytes)
    }
}
