//! The scene ready for rays: a hierarchy of boxes over all its triangles.

use crate::packet::{LANES, Lane, Mask};
use crate::triangles::{Tag, Triangles};
use crate::{TruthError, surface, walk};
use glam::{DVec3, Vec3};
use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use umbrage_scene::Scene;

/// Boxes are larger than their triangles by this share of the scene. Box tests run in single precision; with rays that
/// start within [`FAR_START`] extents their error stays below 40 of its steps, 2.4e-6.
const BOX_MARGIN: f32 = 4e-6;
/// Rays from farther away, in extents of the scene, start where they come near it instead.
const FAR_START: f64 = 4.0;

/// What a box costs beside a triangle, which decides how many triangles a leaf has. Boxes are tested in half the precision
/// and less than half the steps; rays were fastest with 0.5 to 1.
const LEAF_COST: f32 = 1.0;

/// A ray. Distances along it are metres, because `way` has unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, world space, metres.
    pub origin_world: DVec3,
    /// Where it goes; unit length.
    pub way: DVec3,
    /// What is nearer than this does not count, metres.
    pub from_m: f64,
    /// What is farther than this does not count, metres; may be infinite.
    pub to_m: f64,
}

/// What a ray of sight found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Metres from the ray's origin.
    pub distance_m: f64,
    /// Which triangle, for [`Rays::normal`] and [`Rays::instance`].
    pub slot: u32,
}

/// A scene that rays can be traced through.
///
/// Geometry is kept in single precision, as the renderer has it, relative to the scene's middle; intersections are found
/// in double precision. So nothing needs an epsilon but the scene's own rounding, see [`Rays::offset_m`].
#[derive(Debug)]
pub struct Rays<'a> {
    scene: &'a Scene,
    pub(crate) triangles: Triangles,
    /// Each has the boxes of its children; unused ones are [`NO_CHILD`]. The first is the root.
    pub(crate) nodes: Vec<[Bvh2Node; 4]>,
    /// Is any object no receiver? Only then is it asked which one a pixel shows.
    has_exempt: bool,
}

/// Nodes and leaves that are still to be visited: index of the node or of the leaf's first triangle, triangles (0: a
/// node), and the rays that reach it. Kept between rays to spare allocations.
#[derive(Debug, Default)]
pub struct Stack(pub(crate) Vec<(u32, u32, Mask)>);

/// Stands in a node that has less than four children.
pub(crate) const NO_CHILD: u32 = u32::MAX;

/// Takes every second level out of a binary hierarchy: half as many steps, each with as many boxes as the two together.
fn four_wide(binary: &[Bvh2Node]) -> Vec<[Bvh2Node; 4]> {
    let nobody = || Bvh2Node { first_index: NO_CHILD, ..Bvh2Node::default() };
    let area = |node: &Bvh2Node| {
        let size = node.max - node.min;
        size.x * size.y + size.y * size.z + size.z * size.x
    };
    let mut wide = vec![[nobody(); 4]];
    // Which node's children go where.
    let mut todo = vec![(binary[0], 0usize)];
    while let Some((node, place)) = todo.pop() {
        let mut children = vec![node];
        // The largest inner node gives way to its two children.
        while children.len() < 4 {
            let inner = (0..children.len()).filter(|i| children[*i].prim_count == 0);
            let largest = inner.max_by(|a, b| area(&children[*a]).total_cmp(&area(&children[*b])));
            let Some(largest) = largest else { break };
            let first = children.swap_remove(largest).first_index as usize;
            children.extend_from_slice(&binary[first..first + 2]);
        }
        for (slot, child) in children.into_iter().enumerate() {
            let mut kept = child;
            if child.prim_count == 0 {
                kept.first_index = wide.len() as u32;
                todo.push((child, wide.len()));
                wide.push([nobody(); 4]);
            }
            wide[place][slot] = kept;
        }
    }
    wide
}

impl<'a> Rays<'a> {
    /// Builds the hierarchy, on all cores.
    ///
    /// # Errors
    /// [`TruthError::TooManyTriangles`].
    pub fn new(scene: &'a Scene) -> Result<Self, TruthError> {
        let mut triangles = Triangles::new(scene)?;
        let has_exempt = scene.instances.iter().any(|instance| !instance.roles.receiver);
        if triangles.corners.is_empty() {
            return Ok(Self { scene, triangles, nodes: Vec::new(), has_exempt });
        }
        let params = BvhBuildParams { collapse_traversal_cost: LEAF_COST, ..BvhBuildParams::medium_build() };
        let built = build_bvh2(&triangles.corners, params, &mut std::time::Duration::default());
        // In the order of the leaves, so that a leaf's triangles lie side by side.
        let order = &built.primitive_indices;
        triangles.corners = order.iter().map(|i| triangles.corners[*i as usize]).collect();
        triangles.tags = order.iter().map(|i| triangles.tags[*i as usize]).collect();
        let margin = Vec3::splat(BOX_MARGIN * triangles.extent_m.max(f32::MIN_POSITIVE));
        let mut nodes = four_wide(&built.nodes);
        for child in nodes.iter_mut().flatten() {
            child.min -= margin;
            child.max += margin;
        }
        Ok(Self { scene, triangles, nodes, has_exempt })
    }

    /// Triangles that rays can hit.
    pub fn triangle_count(&self) -> usize {
        self.triangles.corners.len()
    }

    /// What the triangles and their hierarchy take, bytes. The scene itself is not counted.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
            + size_of_val(&self.triangles.corners[..])
            + size_of_val(&self.triangles.tags[..])
            + size_of_val(&self.triangles.first_of_instance[..])
    }

    /// How far off a surface a ray to the light starts, metres: what single-precision vertices may be off at that place,
    /// four steps of the largest coordinate that went into them. So two coincident surfaces of different meshes do not
    /// shadow each other, at any scale, and nothing that the scene can resolve is passed over.
    pub fn offset_m(&self) -> f64 {
        4.0 * f64::from(f32::EPSILON) * f64::from(self.triangles.magnitude_m)
    }

    /// Half the edge of the box around all triangles, metres; never 0.
    pub fn extent_m(&self) -> f64 {
        f64::from(self.triangles.extent_m.max(f32::MIN_POSITIVE))
    }

    /// Unit normal of a triangle's front.
    pub fn normal(&self, slot: u32) -> DVec3 {
        let [a, b, c] = self.triangles.corners[slot as usize].0.map(Vec3::as_dvec3);
        (b - a).cross(c - a).normalize_or_zero()
    }

    /// Index of the instance that a triangle belongs to.
    pub fn instance(&self, slot: u32) -> usize {
        self.triangles.origin_of(self.triangles.tags[slot as usize]).0
    }

    /// Does a triangle belong to an object that receives no shadow?
    pub fn is_exempt(&self, slot: u32) -> bool {
        self.has_exempt && !self.scene.instances[self.instance(slot)].roles.receiver
    }

    /// The rays of a packet, and by how much their distances are shorter there.
    #[inline]
    fn place(&self, rays: &[Ray]) -> ([Lane; LANES], [f64; LANES]) {
        let far_m = FAR_START * self.extent_m();
        let mut skipped = [0.0; LANES];
        let blank = Lane { origin: DVec3::ZERO, way: DVec3::X, t_min: 0.0, t_max: 0.0 };
        let mut placed = [blank; LANES];
        for ((ray, lane), skipped) in rays.iter().zip(&mut placed).zip(&mut skipped) {
            let origin = ray.origin_world - self.triangles.center_world;
            if origin.length_squared() > far_m * far_m {
                *skipped = origin.length() - 0.5 * far_m;
            }
            *lane = Lane {
                origin: origin + ray.way * *skipped,
                way: ray.way,
                t_min: ray.from_m - *skipped,
                t_max: ray.to_m - *skipped,
            };
        }
        (placed, skipped)
    }

    /// What the rays of a packet meet first, [`LANES`] at most: surfaces that are mixed by alpha are looked through, and so
    /// are the backs of single-sided ones and the holes of cut-outs.
    pub fn nearest(&self, rays: &[Ray], stack: &mut Stack) -> [Option<Found>; LANES] {
        self.first(rays, true, stack)
    }

    /// The first thing that takes light from a ray.
    pub fn blocker(&self, ray: &Ray, stack: &mut Stack) -> Option<Found> {
        self.first(std::slice::from_ref(ray), false, stack)[0]
    }

    fn first(&self, rays: &[Ray], sight: bool, stack: &mut Stack) -> [Option<Found>; LANES] {
        let mut nearest = walk::Nearest { sight, found: [None; LANES] };
        if !rays.is_empty() {
            let (placed, skipped) = self.place(rays);
            walk::find_nearest(self, &placed[..rays.len().min(LANES)], &mut nearest, stack);
            for (found, skipped) in nearest.found.iter_mut().zip(skipped) {
                if let Some(found) = found {
                    found.distance_m += skipped;
                }
            }
        }
        nearest.found
    }

    /// The share of light, for each colour, that passes along the rays of a packet, [`LANES`] at most.
    pub fn light_through(&self, rays: &[Ray], stack: &mut Stack) -> [Vec3; LANES] {
        let mut light = [Vec3::ONE; LANES];
        if !rays.is_empty() {
            let (placed, _) = self.place(rays);
            walk::pass_light(self, &placed[..rays.len().min(LANES)], &mut light, stack);
        }
        light
    }

    /// What a surface lets through where it was hit: light passes what is no blocker as if it were not there.
    #[inline(never)]
    pub(crate) fn pierced(&self, tag: Tag, u: f64, v: f64, sight: bool) -> Vec3 {
        let (instance, triangle) = self.triangles.origin_of(tag);
        if !sight && !self.scene.instances[instance].roles.blocker {
            return Vec3::ONE;
        }
        surface::light_through(self.scene, instance, triangle, u, v)
    }
}
