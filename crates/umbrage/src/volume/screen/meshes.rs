//! Meshes by their index, and what is drawn of them in each of the two ways to find faces.

use super::VolumeProblem;
use crate::volume::{VolumeMesh, VolumePipelines, VolumeSource};
use glam::Vec3;
use umbrage_core::DepthConvention;
use umbrage_core::edges::Adjacency;
use umbrage_core::technique::volume::Silhouette;

/// More meshes than anybody has; lists are as long as the greatest index.
const MOST_MESHES: usize = 1 << 20;

/// A mesh as it was set. Kept, because a light may ask for the other way to find faces later.
#[derive(Debug)]
struct Source {
    positions: Vec<Vec3>,
    adjacency: Adjacency,
    version: u64,
    /// Does any part of it cast from both sides?
    is_open: bool,
}

/// One way to find faces.
#[derive(Debug)]
pub(super) struct Mode {
    pub pipelines: VolumePipelines,
    pub meshes: Vec<Option<VolumeMesh>>,
}

/// What depth and V are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Formats {
    pub depth: wgpu::TextureFormat,
    pub v: wgpu::TextureFormat,
    pub convention: DepthConvention,
}

/// All meshes.
#[derive(Debug)]
pub(super) struct Meshes {
    pub formats: Formats,
    sources: Vec<Option<Source>>,
    /// With a compute pass, and with split edges.
    modes: [Option<Mode>; 2],
    changes: u64,
}

/// What is known of a mesh before its faces are drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    pub version: u64,
    pub is_open: bool,
}

fn at(silhouette: Silhouette) -> usize {
    usize::from(silhouette == Silhouette::Vertex)
}

fn uploaded(device: &wgpu::Device, pipelines: &VolumePipelines, source: &Source) -> Option<VolumeMesh> {
    let source = VolumeSource { positions: &source.positions, adjacency: &source.adjacency };
    VolumeMesh::new(device, pipelines, &source)
}

impl Meshes {
    pub fn new(formats: Formats) -> Self {
        Self { formats, sources: Vec::new(), modes: [None, None], changes: 0 }
    }

    /// Makes pipelines and meshes for a way to find faces, where there are none yet.
    pub fn prepare(&mut self, device: &wgpu::Device, silhouette: Silhouette) {
        let Formats { depth, v, convention } = self.formats;
        if self.modes[at(silhouette)].is_none() {
            let pipelines = VolumePipelines::new(device, silhouette, depth, v, convention);
            let of = |source: &Option<Source>| uploaded(device, &pipelines, source.as_ref()?);
            let meshes = self.sources.iter().map(of).collect();
            self.modes[at(silhouette)] = Some(Mode { pipelines, meshes });
        }
    }

    /// `None` before [`Self::prepare`].
    pub fn mode(&self, silhouette: Silhouette) -> Option<&Mode> {
        self.modes[at(silhouette)].as_ref()
    }

    pub fn set(
        &mut self,
        device: &wgpu::Device,
        index: usize,
        positions: &[Vec3],
        indices: &[u32],
    ) -> Result<(), VolumeProblem> {
        if index >= MOST_MESHES {
            return Err(VolumeProblem::TooMany { what: "mesh", number: index, limit: MOST_MESHES });
        }
        let adjacency = Adjacency::new(positions, indices);
        let is_open = adjacency.two_sided.contains(&true);
        self.changes += 1;
        let source = Source { positions: positions.to_vec(), adjacency, version: self.changes, is_open };
        let is_empty = source.adjacency.triangles.is_empty();
        let mut is_too_large = false;
        for mode in self.modes.iter_mut().flatten() {
            let mesh = uploaded(device, &mode.pipelines, &source);
            is_too_large |= mesh.is_none() && !is_empty;
            put(&mut mode.meshes, index, mesh);
        }
        put(&mut self.sources, index, Some(source));
        if is_too_large { Err(VolumeProblem::MeshTooLarge { mesh: index }) } else { Ok(()) }
    }

    pub fn remove(&mut self, index: usize) {
        for mode in self.modes.iter_mut().flatten() {
            mode.meshes.get_mut(index).map(Option::take);
        }
        self.sources.get_mut(index).map(Option::take);
    }

    pub fn version(&self, index: usize) -> Option<u64> {
        Some(self.sources.get(index)?.as_ref()?.version)
    }

    /// What is known of a mesh, where volumes can be made of it in this way; nothing where it has no triangle.
    pub fn known(&self, silhouette: Silhouette, index: usize) -> Result<Option<Known>, VolumeProblem> {
        let Some(source) = self.sources.get(index).and_then(Option::as_ref) else {
            return Err(VolumeProblem::NoMesh { mesh: index });
        };
        let made = self.mode(silhouette).and_then(|mode| mode.meshes.get(index)).and_then(Option::as_ref);
        match made {
            Some(_) => Ok(Some(Known { version: source.version, is_open: source.is_open })),
            None if source.adjacency.triangles.is_empty() => Ok(None),
            None => Err(VolumeProblem::MeshTooLarge { mesh: index }),
        }
    }

    /// On the GPU, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let meshes = self.modes.iter().flatten().flat_map(|mode| mode.meshes.iter().flatten());
        meshes.map(VolumeMesh::memory_bytes).sum()
    }
}

fn put<T>(list: &mut Vec<Option<T>>, index: usize, value: Option<T>) {
    if list.len() <= index {
        list.resize_with(index + 1, || None);
    }
    list[index] = value;
}
