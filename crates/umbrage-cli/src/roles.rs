//! Which objects throw and receive shadows, as the options have it.

use crate::args::SceneArgs;
use crate::fault::{Fault, suggest};
use umbrage_scene::{Instance, Roles, Scene};

/// So many objects are named to somebody who names none.
const FEW: usize = 8;

/// Takes roles from the objects that are named. What they lack by the file they keep lacking.
///
/// # Errors
/// [`Fault::WrongUse`] for a name that no object has.
pub fn take(scene: &mut Scene, args: &SceneArgs) -> Result<(), Fault> {
    without(scene, "--no-blocker", &args.no_blocker, |roles| roles.blocker = false)?;
    without(scene, "--no-receiver", &args.no_receiver, |roles| roles.receiver = false)
}

fn without(scene: &mut Scene, flag: &str, asked: &[String], take: fn(&mut Roles)) -> Result<(), Fault> {
    for name in asked {
        let chosen = chosen(scene, name).ok_or_else(|| unknown(scene, flag, name))?;
        let meant = |instance: &&mut Instance| chosen.contains(&instance.object);
        scene.instances.iter_mut().filter(meant).for_each(|instance| take(&mut instance.roles));
    }
    Ok(())
}

/// The objects whose nodes have a name, or whose meshes have it, or the one with that number.
fn chosen(scene: &Scene, name: &str) -> Option<Vec<u32>> {
    let objects = |is: &dyn Fn(&Instance) -> bool| {
        let found = scene.instances.iter().filter(|instance| is(instance));
        let mut found: Vec<u32> = found.map(|instance| instance.object).collect();
        found.dedup();
        (!found.is_empty()).then_some(found)
    };
    let number = name.parse::<u32>().ok();
    (!name.is_empty())
        .then(|| {
            objects(&|instance| instance.name == name)
                .or_else(|| objects(&|instance| scene.meshes[instance.mesh].name == name))
        })
        .flatten()
        .or_else(|| objects(&|instance| Some(instance.object) == number))
}

fn unknown(scene: &Scene, flag: &str, name: &str) -> Fault {
    let nodes = scene.instances.iter().map(|instance| instance.name.as_str());
    let meshes = scene.meshes.iter().map(|mesh| mesh.name.as_str());
    let near = suggest(name, nodes.chain(meshes).filter(|name| !name.is_empty()));
    let count = scene.objects();
    let few = few_names(scene);
    Fault::WrongUse(format!("{flag}: there is no object `{name}`{near}; there are {count}, from 0 on{few}"))
}

/// The first of the objects' names, as the end of a sentence; nothing where none has one.
fn few_names(scene: &Scene) -> String {
    let mut names: Vec<&str> = Vec::new();
    for name in scene.instances.iter().map(|instance| instance.name.as_str()) {
        if !name.is_empty() && !names.contains(&name) {
            names.push(name);
        }
        if names.len() > FEW {
            return format!(": {}, ...", names[..FEW].join(", "));
        }
    }
    if names.is_empty() { String::new() } else { format!(": {}", names.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The objects that lost a role.
    fn taken(asked: &[&str]) -> Result<Vec<u32>, Fault> {
        let mut scene = umbrage_scene::load("builtin:contact").expect("a built-in");
        let asked: Vec<String> = asked.iter().map(|name| (*name).to_owned()).collect();
        without(&mut scene, "--no-blocker", &asked, |roles| roles.blocker = false)?;
        assert!(scene.instances.iter().all(|i| i.roles.receiver));
        Ok(scene.instances.iter().filter(|i| !i.roles.blocker).map(|i| i.object).collect())
    }

    #[test]
    fn objects_are_found_by_name_and_number() {
        let scene = umbrage_scene::load("builtin:contact").expect("a built-in");
        let low = scene.instances.iter().find(|i| i.name == "low box").expect("it has one").object;
        assert_eq!(taken(&["low box"]).ok(), Some(vec![low]));
        assert_eq!(taken(&[&low.to_string()]).ok(), Some(vec![low]));
        assert_eq!(taken(&["0", "1", "0"]).ok(), Some(vec![0, 1]));
        assert_eq!(taken(&[]).ok(), Some(vec![]));
    }

    #[test]
    fn a_mesh_stands_for_all_its_objects_unless_a_node_has_its_name() {
        let mut scene = umbrage_scene::load("builtin:columns").expect("a built-in");
        let mesh = scene.instances[1].mesh;
        for instance in &mut scene.instances {
            instance.name = "node".into();
        }
        scene.meshes[mesh].name = "shared".into();
        let sharing = scene.instances.iter().filter(|i| i.mesh == mesh).map(|i| i.object);
        assert_eq!(chosen(&scene, "shared"), Some(sharing.collect()));
        scene.instances[0].name = "shared".into();
        assert_eq!(chosen(&scene, "shared"), Some(vec![0]));
    }

    #[test]
    fn an_unknown_object_is_wrong_use_with_a_suggestion() {
        for (name, word) in [
            ("low bix", "did you mean `low box`?"),
            ("99", "from 0 on: ground, low box, high box, "),
            ("99", "small ball, wall 2 permille, wall 5 permille, ..."),
            ("", "from 0 on"),
            ("-1", "no object `-1`"),
        ] {
            let Err(Fault::WrongUse(message)) = taken(&[name]) else { panic!("{name}") };
            assert!(message.contains(word) && message.starts_with("--no-blocker"), "{message}");
        }
    }
}
