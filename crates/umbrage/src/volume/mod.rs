//! Stencil shadow volumes: the space that a caster darkens, as polygons that the stencil counts over the caller's depth.
//!
//! For each light: [`record_silhouettes`] finds the faces of its casters' volumes (not needed with split edges),
//! [`record_counts`] counts them, and [`record_visibility`] writes V, 1 where nothing was counted. The depth that is counted
//! over must be that of the lit surfaces, transformed as `volume.wgsl` does, by the rows of `world_from_object` and then
//! by `clip_from_world`: then lids and surfaces have equal depths but for the last bits, which depend on the order of corners and
//! on clipping. Faces are drawn a few steps of depth behind where they are, so that lids count as behind their surfaces. Where
//! a renderer's arithmetic is another, an inset puts the lids farther behind.
//!
//! The caller's depth may run either way ([`DepthConvention::Reversed`] or [`DepthConvention::ZeroToOne`]); pipelines are made for
//! one of them. Reversed, lids of far casters are the more exact: steps of a float depth are then fine where casters are far.
//!
//! Counts wrap at 256, so that only their end counts, not the order of their faces; a pixel within exactly 256 volumes would be
//! lit. Where a volume has no end ([`VolumeCaster::far_plane_world`]) the eye's far plane may not cut it: either the device has
//! [`wgpu::Features::DEPTH_CLIP_CONTROL`], or `clip_from_world` has no far plane (`far_m` infinite in
//! [`umbrage_core::projection::perspective`]). A parallel eye needs an end ([`umbrage_core::volume::finite_length_m`]). Faces
//! counted before the surface are always cut at the near plane, where their count begins.
//!
//! [`ScreenVolumes`] does all of this for any number of lights, and ends before a far plane what it can: see there.

mod caster;
mod light;
mod mesh;
mod pipelines;
mod screen;

pub use caster::{VolumeCaster, Winding};
pub use light::{TooManyFaces, VolumeLight};
pub use mesh::{VolumeMesh, VolumeSource};
pub use pipelines::{COUNT_FORMATS, VolumePipelines, choose_count_format};
pub use screen::{
    CUT_LENGTHS, PassWatch, ScreenVolumes, ToldVolumes, VolumeEye, VolumeItem, VolumePass, VolumeProblem,
    VolumeSettings, VolumeWork,
};

use umbrage_core::DepthConvention;
use umbrage_core::technique::volume::{Counting, Stencil};

/// Which faces of a stencil that counts both ways in one draw are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Faces {
    /// Both, in one draw.
    Both,
    /// Those seen from outside.
    Front,
    /// Those seen from inside.
    Back,
}

impl Faces {
    /// The name of the pass that counts them, as in the plan.
    pub fn pass_name(self) -> &'static str {
        match self {
            Self::Both => "back+front",
            Self::Front => "front",
            Self::Back => "back",
        }
    }

    /// The passes of a way to count, in order.
    pub fn passes(stencil: Stencil) -> &'static [Self] {
        match stencil {
            Stencil::TwoSided => &[Self::Both],
            Stencil::TwoPass => &[Self::Back, Self::Front],
        }
    }
}

/// What is counted of a caster: [`Counting`] with `auto` settled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Counted {
    /// Faces behind the surface.
    Behind,
    /// Faces before it.
    Before,
}

impl Counted {
    /// Settles `auto` by whether the eye may be in the caster's shadow.
    pub fn new(counting: Counting, eye_may_be_in_shadow: bool) -> Self {
        match counting {
            Counting::DepthFail => Self::Behind,
            Counting::DepthPass => Self::Before,
            Counting::Auto if eye_may_be_in_shadow => Self::Behind,
            Counting::Auto => Self::Before,
        }
    }

    /// Are faces seen from outside counted up? The others are counted the other way. Before: what is entered through its front
    /// is gone into; behind: what is left through its back was.
    pub fn front_counts_up(self) -> bool {
        self == Self::Before
    }

    /// The depth test that lets through what is counted, over the depth of the lit surfaces, which runs as `depth` says: faces at the
    /// depth of a surface are behind it.
    pub fn depth_compare(self, depth: DepthConvention) -> wgpu::CompareFunction {
        match (self, depth.is_reversed()) {
            (Self::Before, true) => wgpu::CompareFunction::Greater,
            (Self::Before, false) => wgpu::CompareFunction::Less,
            (Self::Behind, true) => wgpu::CompareFunction::LessEqual,
            (Self::Behind, false) => wgpu::CompareFunction::GreaterEqual,
        }
    }
}

/// Records a compute pass in which `find` calls [`find_silhouettes`] for one light or several.
pub fn record_silhouettes(
    encoder: &mut wgpu::CommandEncoder,
    timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
    find: impl FnOnce(&mut wgpu::ComputePass<'_>),
) {
    let mut recorded = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
        label: Some("silhouettes"),
        timestamp_writes: timestamps,
    });
    find(&mut recorded);
}

/// Writes those faces of a light's volumes that have to be found. They hold until light or casters change:
/// [`VolumeLight::found`] says so.
pub fn find_silhouettes(
    recorded: &mut wgpu::ComputePass<'_>,
    pipelines: &VolumePipelines,
    light: &VolumeLight,
    meshes: &[Option<VolumeMesh>],
) {
    let (Some(silhouettes), Some(room)) = (&pipelines.silhouettes, &light.room) else { return };
    recorded.set_pipeline(silhouettes);
    for (number, caster) in light.casters().iter().enumerate().filter(|(number, _)| light.is_stale(*number)) {
        let Some(mesh) = meshes.get(caster.mesh).and_then(Option::as_ref) else { continue };
        let items = mesh.edges() + if caster.has_caps() { mesh.triangles() } else { 0 };
        let groups = items.div_ceil(64);
        if groups == 0 {
            continue;
        }
        // A dispatch has 65,535 groups along an axis at most.
        let rows = groups.div_ceil(65_535);
        recorded.set_bind_group(0, &room.silhouette_group, &[light.offset(number, false)]);
        recorded.set_bind_group(1, &mesh.edge_group, &[]);
        recorded.dispatch_workgroups(groups.div_ceil(rows), rows, 1);
    }
}

/// Records a pass in which `draw` calls [`count_volumes`]. `depth_stencil` keeps its depth; its stencil is `cleared` before the
/// first pass of a light. `scissor` is left, top, width, height, pixels.
pub fn record_counts(
    encoder: &mut wgpu::CommandEncoder,
    depth_stencil: &wgpu::TextureView,
    cleared: bool,
    scissor: [u32; 4],
    timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
) {
    let load = if cleared { wgpu::LoadOp::Clear(0) } else { wgpu::LoadOp::Load };
    let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("volumes"),
        color_attachments: &[],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth_stencil,
            depth_ops: None,
            stencil_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
        }),
        timestamp_writes: timestamps,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let [x, y, width, height] = scissor;
    recorded.set_scissor_rect(x, y, width, height);
    draw(&mut recorded);
}

/// Counts a light's volumes: `draw` says which casters, by their numbers, and how each is counted.
pub fn count_volumes(
    recorded: &mut wgpu::RenderPass<'_>,
    pipelines: &VolumePipelines,
    light: &VolumeLight,
    meshes: &[Option<VolumeMesh>],
    faces: Faces,
    draw: &[(usize, Counted)],
) {
    draw_volumes(recorded, light, meshes, draw, |counted, winding| pipelines.counts(counted, faces, winding));
}

/// Draws volumes with pipelines of one's own: `pipeline` is asked for each draw.
pub fn draw_volumes<'a>(
    recorded: &mut wgpu::RenderPass<'_>,
    light: &VolumeLight,
    meshes: &[Option<VolumeMesh>],
    draw: &[(usize, Counted)],
    pipeline: impl Fn(Counted, Winding) -> &'a wgpu::RenderPipeline,
) {
    let Some(room) = &light.room else { return };
    for (number, counted) in draw {
        let Some(caster) = light.casters().get(*number) else { continue };
        let Some(mesh) = meshes.get(caster.mesh).and_then(Option::as_ref) else { continue };
        match mesh.split() {
            None => {
                recorded.set_pipeline(pipeline(*counted, caster.winding));
                recorded.set_bind_group(0, &room.draw_group, &[light.offset(*number, false)]);
                recorded.set_bind_group(1, &mesh.position_group, &[]);
                recorded.set_index_buffer(room.indices.slice(..), wgpu::IndexFormat::Uint32);
                recorded.draw_indexed_indirect(&room.counts, light.counts_offset(*number));
            }
            Some(split) => {
                recorded.set_vertex_buffer(0, split.vertices.slice(..));
                recorded.set_index_buffer(split.indices.slice(..), wgpu::IndexFormat::Uint32);
                for (range, reversed) in split.draws(caster.both_sides) {
                    recorded.set_pipeline(pipeline(*counted, caster.winding.turned(reversed)));
                    recorded.set_bind_group(0, &room.draw_group, &[light.offset(*number, reversed)]);
                    recorded.set_bind_group(1, &mesh.position_group, &[]);
                    recorded.draw_indexed(range, 0, 0..1);
                }
            }
        }
    }
}

/// Records the pass that writes V of a light, in which `draw` calls [`write_visibility`]: 1 where the stencil counted nothing, 0
/// elsewhere.
pub fn record_visibility(
    encoder: &mut wgpu::CommandEncoder,
    depth_stencil: &wgpu::TextureView,
    v: &wgpu::TextureView,
    timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
) {
    let mut recorded = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("mask"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: v,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth_stencil,
            depth_ops: None,
            stencil_ops: None,
        }),
        timestamp_writes: timestamps,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    draw(&mut recorded);
}

/// Writes 1 where the stencil counted nothing.
pub fn write_visibility(recorded: &mut wgpu::RenderPass<'_>, pipelines: &VolumePipelines) {
    recorded.set_pipeline(&pipelines.visibility);
    recorded.set_stencil_reference(0);
    recorded.draw(0..3, 0..1);
}
