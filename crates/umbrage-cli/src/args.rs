//! Every command and option. The parser, the help texts, the completions and the man pages are made from these.

mod bench;
mod split_edges;

pub use bench::{BenchArgs, BenchCommand, ThreadedArgs};
pub use split_edges::SplitEdgesArgs;

use crate::specs::{self, CameraChoice, CaseRef, LightSpec, Pair, TechniqueSpec};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use glam::{UVec2, Vec3};
use std::path::PathBuf;
use umbrage_render::View;
use umbrage_render::umbrage::core::technique::{DEFAULT, TECHNIQUES};

/// Real-time shadows: draw a scene with any technique, see what it does and what it costs.
#[derive(Debug, Parser)]
#[command(
    name = "umbrage",
    version,
    subcommand_required = true,
    after_help = "Start with `umbrage render`: it draws the built-in scene into umbrage.png.\n\
                  `umbrage doctor` says what this machine can do and what is missing.\n\
                  Exit status: 0 done, 1 failed, 2 wrong use, 130 stopped by Ctrl-C."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What the command can do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw one picture of a scene
    Render(Box<RenderArgs>),
    /// Find by rays how much of a light each pixel really sees
    Truth(Box<TruthArgs>),
    /// Measure every technique against the truth: a report of errors beside costs
    Compare(Box<CompareArgs>),
    /// Measure what techniques cost, side by side in one process
    Bench(Box<BenchArgs>),
    /// List the techniques, their choices and parameters
    Techniques(TechniquesArgs),
    /// Print the passes of a technique: targets, states, what is drawn
    Passes(PassesArgs),
    /// Print shader modules, ready to be pasted into your own renderer
    Wgsl(WgslArgs),
    /// Rewrite an OBJ file so that a vertex shader alone can pull shadow volumes out of it
    SplitEdges(SplitEdgesArgs),
    /// Say what this machine's graphics adapters can do, and what is missing
    Doctor(DoctorArgs),
    /// Print the completions of a shell
    ///
    /// For example: umbrage completions bash > ~/.local/share/bash-completion/completions/umbrage
    Completions {
        /// Which shell
        shell: clap_complete::Shell,
    },
    /// Print the man page, or that of one command, as roff
    ///
    /// For example: umbrage man render | man -l -
    Man {
        /// Which command's page
        command: Option<String>,
    },
}

/// Which scene, seen how, lit by what. Shared by all commands that draw.
#[derive(Args, Debug)]
pub struct SceneArgs {
    /// A .gltf, .glb or .obj file, or builtin:NAME
    ///
    /// Built in are torus, columns, tilt, contact and knots; builtin:columns?scale=10&seed=3 makes one larger and other.
    #[arg(default_value = "builtin:torus")]
    pub scene: String,

    /// Show an animated scene as it is after this many seconds; without it the scene is at rest
    ///
    /// After its end an animation starts again. A glTF file's first animation plays unless --animation names another.
    /// What is fitted to the scene is fitted to that moment: give --camera and --light to pictures of a sequence.
    #[arg(long, value_name = "SECONDS", value_parser = specs::seconds, allow_negative_numbers = true, help_heading = "Scene")]
    pub time: Option<f32>,

    /// Which of the scene's animations plays, by name or number
    #[arg(long, value_name = "N", requires = "time", help_heading = "Scene")]
    pub animation: Option<String>,

    /// Lay a matte ground under the scene, for its shadow to fall on
    #[arg(long, help_heading = "Scene")]
    pub ground: bool,

    /// A camera of the scene (its number or name), or key=value,... of position, target, up, fov, near, far
    ///
    /// Places are x:y:z in metres, fov is the full angle from bottom to top in degrees, near and far are in metres. What is
    /// not said comes from the scene's first camera, or from one that holds the whole scene. A position without target
    /// looks at the middle of the scene.
    #[arg(long, value_name = "SPEC", value_parser = specs::camera, help_heading = "Scene")]
    pub camera: Option<CameraChoice>,

    /// A light, key=value,...; replaces the scene's lights, may be given several times
    ///
    /// Without keys that say otherwise it is a white spot light that aims at the middle of the scene.
    ///
    ///   kind=spot|point|directional
    ///   position=x:y:z      metres
    ///   target=x:y:z        where it aims; or direction=x:y:z, where its light travels to
    ///   color=r:g:b         linear, or #rrggbb (sRGB)
    ///   candela=N           spot and point lights; lux=N for directional ones.
    ///                       Default: pi lux at the target
    ///   outer=DEG           from the axis to where the cone ends. Default 45
    ///   inner=DEG           from the axis to where it begins to fade. Default 0.8 outer
    ///   range=M             where the light has faded to nothing. Default: never
    ///   radius=M            a shining sphere instead of a point; or disc=M, a disc of that radius, or
    ///                       rect=W:H, a rectangle, both across the direction. The truth softens by these,
    ///                       and the technique multi-view
    ///   angle=DEG           across the disc of a sun (directional); 0.53 is the real one's
    ///   near=M far=M        planes of the shadow map. Default: fitted to the scene
    ///   cookie=FILE         a slide (png, jpg, webp) in front of a spot light
    ///
    /// Quote the whole in PowerShell, and wherever a path holds spaces.
    #[arg(long, value_name = "SPEC", value_parser = specs::light, help_heading = "Scene", verbatim_doc_comment)]
    pub light: Vec<LightSpec>,

    /// Lights, camera, size and background of a case of a JSON file of cases, as FILE:CASE
    #[arg(long, value_name = "FILE:CASE", value_parser = specs::case_ref, conflicts_with = "light", help_heading = "Scene")]
    pub lights_from: Option<CaseRef>,

    /// Keep only these of the lights, by number or name
    #[arg(long, value_name = "N,...", value_delimiter = ',', help_heading = "Scene")]
    pub lights: Vec<String>,

    /// Let this object throw no shadows; may be given several times
    ///
    /// Names are those of nodes, then of meshes, of a glTF file, and of the materials of an OBJ file; every object of that name
    /// is meant. A number counts objects from 0. A glTF file may say so itself, in the extras of a node:
    /// "umbrage": {"blocker": false, "receiver": false}.
    #[arg(long, value_name = "NAME", help_heading = "Scene")]
    pub no_blocker: Vec<String>,

    /// Let no shadows fall on this object; may be given several times
    #[arg(long, value_name = "NAME", help_heading = "Scene")]
    pub no_receiver: Vec<String>,

    /// Width and height in pixels [default: 1280x720]
    #[arg(long, value_name = "WxH", value_parser = specs::size, help_heading = "Picture")]
    pub size: Option<UVec2>,

    /// Samples a pixel: 4 smooths the edges of surfaces (not of shadows)
    #[arg(long, value_name = "N", default_value = "1", value_parser = samples(), help_heading = "Picture")]
    pub msaa: u32,

    /// How surfaces answer light: as their material says, or all as ambient, Lambert and Blinn
    #[arg(long, value_name = "HOW", default_value = "material", value_parser = ["material", "documents"], help_heading = "Picture")]
    pub shading: String,

    /// Light from everywhere, as a share of the brightest light's, 0 to 1
    #[arg(long, value_name = "X", default_value_t = 0.08, value_parser = specs::share, allow_negative_numbers = true, help_heading = "Picture")]
    pub ambient: f32,

    /// Share of the diffuse light that stays in shadow, so that shadows do not look flat, 0 to 1
    #[arg(long, value_name = "X", default_value_t = 0.1, value_parser = specs::share, allow_negative_numbers = true, help_heading = "Picture")]
    pub fill: f32,

    /// Factor from radiance to picture, or auto: white paper in full light is just white
    #[arg(long, value_name = "X", default_value = "auto", value_parser = specs::exposure, allow_negative_numbers = true, help_heading = "Picture")]
    pub exposure: specs::Exposure,

    /// Colour where nothing is drawn: r:g:b (linear) or #rrggbb (sRGB)
    #[arg(long, value_name = "COLOR", value_parser = specs::color, help_heading = "Picture")]
    pub background: Option<Vec3>,

    /// Draw every caster into the maps, also floors and walls that can be shown to shadow nothing: to see what leaving
    /// them out saves. Changes no picture
    #[arg(long, help_heading = "Machine")]
    pub all_casters: bool,

    /// A file with a WGSL function that moves every vertex, in maps and pictures: fn umbrage_deform(p_world: vec3f, p_object:
    /// vec3f, time_s: f32) -> vec3f. It is told --time
    #[arg(long, value_name = "FILE", help_heading = "Scene")]
    pub deform: Option<PathBuf>,

    /// How far --deform may move a vertex, metres: what is culled and fitted keeps so much room
    #[arg(long, value_name = "METRES", value_parser = specs::length, default_value = "0", requires = "deform", help_heading = "Scene")]
    pub deform_reach: f32,

    /// A file with the weights of the filter `kernel`: fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f, of
    /// four texels whose centres lie so many texels from the receiver; view.width_texel is the parameter `width`
    #[arg(long, value_name = "FILE", help_heading = "Picture")]
    pub kernel: Option<PathBuf>,

    /// Use the first graphics adapter whose name contains this; `umbrage doctor` lists them
    #[arg(long, value_name = "NAME", env = "UMBRAGE_ADAPTER", help_heading = "Machine")]
    pub adapter: Option<String>,
}

const RENDER_EXAMPLES: &str = "Examples:
  umbrage render
      the built-in scene into umbrage.png
  umbrage render model.glb --ground -o model.png
      your model on a ground, with its own lights, or a light that suits it
  umbrage render fox.glb --ground --animation Walk --time 0.35
      a moment of an animation
  umbrage render builtin:torus --technique hard --set map_size=128 -o stairs.png
      what a coarse map without filter looks like
  umbrage render builtin:columns --view depth -o map.png
      the light's map itself: near black, far white
  umbrage render builtin:columns --view density --set projection=lispsm -o density.png
      texels of the map in each pixel, with a legend and a histogram; --json has the numbers
  umbrage render model.obj --light kind=directional,direction=-1:-2:-1,lux=3 --size 1920x1080 --msaa 4
      under a sun of your own
  umbrage render --frames 20 --statistics --json
      what each pass costs, for a program to read

The picture is always PNG. `umbrage techniques` lists what --technique and --set take.";

/// `umbrage render`
#[derive(Args, Debug)]
#[command(after_long_help = RENDER_EXAMPLES, after_help = "`umbrage render --help` has examples and the keys of --light.")]
pub struct RenderArgs {
    /// Scene, lights, picture, machine.
    #[command(flatten)]
    pub scene: SceneArgs,

    /// Where the picture goes; a file of that name is replaced
    #[arg(short, long, value_name = "FILE", default_value = "umbrage.png", help_heading = "Output")]
    pub output: PathBuf,

    /// How shadows are made
    #[arg(short, long, value_name = "ID", default_value = DEFAULT, value_parser = technique_ids(&[]), help_heading = "Shadow")]
    pub technique: String,

    /// Change a choice or parameter of the technique; may be given several times
    #[arg(short, long, value_name = "KEY=VALUE", value_parser = specs::pair, help_heading = "Shadow")]
    pub set: Vec<Pair>,

    /// Look up maps as they are while nothing moves, as an application would; without it every frame draws all its maps,
    /// so that costs are those of a moving scene
    #[arg(long, help_heading = "Shadow")]
    pub reuse: bool,

    /// What the picture shows
    #[arg(long, value_name = "VIEW", default_value = "final", value_parser = view_ids(), help_heading = "Picture")]
    pub view: String,

    /// Which light the views of one light show, counted from 0
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Picture")]
    pub light_index: usize,

    /// Draw N frames; with more than one, the first (which warms up) is left out of the median
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000), help_heading = "Output")]
    pub frames: u32,

    /// Let the GPU count vertices and fragments of each pass
    #[arg(long, help_heading = "Output")]
    pub statistics: bool,

    /// Print one JSON object with everything that is known about the picture
    #[arg(long, help_heading = "Output")]
    pub json: bool,

    /// Print nothing but errors
    #[arg(short, long, conflicts_with = "json", help_heading = "Output")]
    pub quiet: bool,
}

/// How carefully truth is found.
#[derive(Args, Debug)]
pub struct QualityArgs {
    /// Rays from each pixel to a light that has a shape; a light that is a point takes one exact ray
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=65_536), help_heading = "Truth")]
    pub samples: u32,

    /// Which of many equally good sets of rays; the same seed gives the same picture on every machine
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Truth")]
    pub seed: u32,
}

const TRUTH_EXAMPLES: &str = "Examples:
  umbrage truth
      V of the built-in scene's light into truth.png: white lit, black shadow
  umbrage truth model.glb --ground --light radius=0.2 --samples 256
      under a shining ball: umbra and penumbra
  umbrage truth builtin:columns --view final -o true.png
      the lit scene with true shadows of all its lights

Lights get a shape by --light (radius, disc, rect, angle). Surfaces mixed by alpha colour the light that passes them; they
are looked through by the camera. --view final needs a graphics adapter, --view visibility does not.";

/// `umbrage truth`
#[derive(Args, Debug)]
#[command(after_long_help = TRUTH_EXAMPLES, after_help = "`umbrage truth --help` has examples and the keys of --light.")]
pub struct TruthArgs {
    /// Scene, lights, picture, machine.
    #[command(flatten)]
    pub scene: SceneArgs,

    /// How carefully truth is found.
    #[command(flatten)]
    pub quality: QualityArgs,

    /// Where the picture goes; a file of that name is replaced
    #[arg(short, long, value_name = "FILE", default_value = "truth.png", help_heading = "Output")]
    pub output: PathBuf,

    /// What the picture shows
    #[arg(long, value_name = "VIEW", default_value = "visibility", value_parser = truth_views(), help_heading = "Picture")]
    pub view: String,

    /// Which light's V is shown, counted from 0
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Picture")]
    pub light_index: usize,

    /// Print one JSON object
    #[arg(long, help_heading = "Output")]
    pub json: bool,

    /// Print nothing but errors
    #[arg(short, long, conflicts_with = "json", help_heading = "Output")]
    pub quiet: bool,
}

const COMPARE_EXAMPLES: &str = "Examples:
  umbrage compare
      every technique on the built-in scene, into the folder report: open report/index.html
  umbrage compare model.glb --ground --techniques hard,linear --set map_size=512 -o small-maps
  umbrage compare model.glb -t linear:bias=slope,linear:bias=auto,pcf:width=9 --set map_size=1024 -o biases
      the same technique with other settings, side by side
  umbrage compare builtin:columns --path frames=8,turn=4
      along a camera's path: flicker, too
  umbrage compare builtin:torus --light rect=0.5:0.5,position=-3:5:4 --samples 256 --json
      under a shining rectangle; one JSON object and no report

Each light is measured alone. `cost` is the median difference between neighbouring frames with and without shadows.";

/// `umbrage compare`
#[derive(Args, Debug)]
#[command(after_long_help = COMPARE_EXAMPLES)]
pub struct CompareArgs {
    /// Scene, lights, picture, machine.
    #[command(flatten)]
    pub scene: SceneArgs,

    /// How carefully truth is found.
    #[command(flatten)]
    pub quality: QualityArgs,

    /// Which techniques, by commas, or all; each may be followed by settings of its own, as ID:KEY=VALUE:KEY=VALUE
    ///
    /// What a technique has of its own goes before --set. The same technique may stand there several times, with other
    /// settings.
    #[arg(short, long, value_name = "ID[:KEY=VALUE]...,...", default_value = "all", value_delimiter = ',',
          value_parser = TechniqueParser, help_heading = "Shadow")]
    pub techniques: Vec<TechniqueSpec>,

    /// Change a choice or parameter in every technique that has it; one at least must
    #[arg(short, long, value_name = "KEY=VALUE", value_parser = specs::pair, help_heading = "Shadow")]
    pub set: Vec<Pair>,

    /// Cameras of the scene by number or name, or all; instead of --camera
    #[arg(long, value_name = "N,...", value_delimiter = ',', conflicts_with_all = ["camera", "path"], help_heading = "Scene")]
    pub cameras: Vec<String>,

    /// A path of the camera, key=value,...: frames=N (8), turn=DEG around the scene's middle, move=x:y:z metres, in all
    #[arg(long, value_name = "SPEC", value_parser = specs::path, help_heading = "Scene")]
    pub path: Option<specs::PathSpec>,

    /// The report's folder; an earlier report there is replaced. Default: report, and none with --json
    #[arg(short, long, value_name = "FOLDER", help_heading = "Output")]
    pub output: Option<PathBuf>,

    /// Timed frames of each technique, after one that warms up
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=10_000), help_heading = "Output")]
    pub frames: u32,

    /// Print one JSON object
    #[arg(long, help_heading = "Output")]
    pub json: bool,
}

/// `umbrage techniques`
#[derive(Args, Debug)]
pub struct TechniquesArgs {
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,

    /// Print every combination of the five choices of a map, and whether it is valid
    #[arg(long)]
    pub matrix: bool,
}

/// `umbrage passes`
#[derive(Args, Debug)]
pub struct PassesArgs {
    /// Which technique
    #[arg(value_name = "ID", value_parser = technique_ids(&[]))]
    pub technique: String,

    /// Change a choice or parameter of the technique; may be given several times
    #[arg(short, long, value_name = "KEY=VALUE", value_parser = specs::pair)]
    pub set: Vec<Pair>,

    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `umbrage wgsl`
#[derive(Args, Debug)]
#[command(after_help = "Example: umbrage wgsl filter/linear light > shadow.wgsl")]
pub struct WgslArgs {
    /// Which modules; what they need comes with them. Without any: the list
    #[arg(value_name = "MODULE")]
    pub modules: Vec<String>,
}

/// `umbrage doctor`
#[derive(Args, Debug)]
pub struct DoctorArgs {
    /// Look at the first adapter whose name contains this
    #[arg(long, value_name = "NAME", env = "UMBRAGE_ADAPTER")]
    pub adapter: Option<String>,

    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

fn technique_ids(more: &[&'static str]) -> PossibleValuesParser {
    let more = more.iter().map(|id| PossibleValue::new(*id).help("every technique"));
    PossibleValuesParser::new(TECHNIQUES.iter().map(|t| PossibleValue::new(t.id).help(t.summary)).chain(more))
}

/// Reads `ID:KEY=VALUE`, and tells help and completions the ids.
#[derive(Clone, Debug)]
struct TechniqueParser;

impl TypedValueParser for TechniqueParser {
    type Value = TechniqueSpec;

    fn parse_ref(
        &self,
        command: &clap::Command,
        arg: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<Self::Value, clap::Error> {
        // The words for what is wrong are those of all our other options.
        let parser: fn(&str) -> Result<TechniqueSpec, String> = specs::technique;
        parser.parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let ids = TECHNIQUES.iter().map(|t| PossibleValue::new(t.id).help(t.summary));
        Some(Box::new(ids.chain([PossibleValue::new("all").help("every technique")])))
    }
}

fn view_ids() -> PossibleValuesParser {
    PossibleValuesParser::new(View::ALL.map(|view| PossibleValue::new(view.id()).help(view.summary())))
}

fn truth_views() -> PossibleValuesParser {
    PossibleValuesParser::new(
        [View::Visibility, View::Final].map(|view| PossibleValue::new(view.id()).help(view.summary())),
    )
}

fn samples() -> impl TypedValueParser<Value = u32> {
    PossibleValuesParser::new(["1", "4"]).map(|text| if text == "4" { 4 } else { 1 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definitions_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_help_names_every_built_in_scene() {
        let mut command = Cli::command();
        let render = command.find_subcommand_mut("render").expect("render is a command");
        let help = render.render_long_help().to_string();
        for builtin in umbrage_scene::builtins() {
            assert!(help.contains(builtin.name), "{}", builtin.name);
        }
    }
}
