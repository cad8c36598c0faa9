//! What stands for a light, a mesh, a caster or a receiver.

use super::ShadowsError;
use slotmap::{DefaultKey, Key, SlotMap};

/// A place in a store, and whose store.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Id {
    pub key: DefaultKey,
    pub of: u32,
}

macro_rules! handle {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub(super) Id);
    };
}

handle! {
    /// A light of one [`Shadows`](super::Shadows). Eight bytes and four; copies stand for the same light.
    LightHandle
}
handle! {
    /// A mesh of one [`Shadows`](super::Shadows).
    MeshHandle
}
handle! {
    /// A caster of one [`Shadows`](super::Shadows).
    CasterHandle
}
handle! {
    /// A receiver of one [`Shadows`](super::Shadows) that casts nothing.
    ReceiverHandle
}

/// Values by handles. Numbers of what was removed are used again, but a handle of it stays refused.
#[derive(Debug)]
pub(super) struct Store<T> {
    values: SlotMap<DefaultKey, T>,
    of: u32,
    what: &'static str,
}

/// The number of a key: below the most that a store ever held at once.
pub(super) fn index(key: DefaultKey) -> usize {
    // The lower half of slotmap's number counts places from 1 on.
    (key.data().as_ffi() as u32 as usize).saturating_sub(1)
}

impl<T> Store<T> {
    pub fn new(what: &'static str, of: u32) -> Self {
        Self { values: SlotMap::new(), of, what }
    }

    pub fn insert(&mut self, value: T) -> Id {
        Id { key: self.values.insert(value), of: self.of }
    }

    fn check(&self, id: Id) -> Result<(), ShadowsError> {
        if id.of != self.of {
            return Err(ShadowsError::OfAnother { what: self.what });
        }
        if !self.values.contains_key(id.key) {
            return Err(ShadowsError::Removed { what: self.what });
        }
        Ok(())
    }

    pub fn get(&self, id: Id) -> Result<&T, ShadowsError> {
        self.check(id)?;
        self.values.get(id.key).ok_or(ShadowsError::Removed { what: self.what })
    }

    pub fn get_mut(&mut self, id: Id) -> Result<&mut T, ShadowsError> {
        self.check(id)?;
        self.values.get_mut(id.key).ok_or(ShadowsError::Removed { what: self.what })
    }

    pub fn remove(&mut self, id: Id) -> Result<T, ShadowsError> {
        self.check(id)?;
        self.values.remove(id.key).ok_or(ShadowsError::Removed { what: self.what })
    }

    pub fn at(&self, key: DefaultKey) -> Option<&T> {
        self.values.get(key)
    }

    pub fn at_mut(&mut self, key: DefaultKey) -> Option<&mut T> {
        self.values.get_mut(key)
    }

    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// In the order of their numbers.
    pub fn iter(&self) -> impl Iterator<Item = (DefaultKey, &T)> {
        self.values.iter()
    }

    pub fn iter_mut(&mut self) -> impl Iterator<Item = (DefaultKey, &mut T)> {
        self.values.iter_mut()
    }

    pub fn id(&self, key: DefaultKey) -> Id {
        Id { key, of: self.of }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_used_again_and_old_handles_are_refused() {
        let mut store = Store::new("light", 1);
        let (a, b) = (store.insert('a'), store.insert('b'));
        assert_eq!((index(a.key), index(b.key)), (0, 1));
        assert_eq!(store.remove(a), Ok('a'));
        let c = store.insert('c');
        assert_eq!(index(c.key), 0);
        assert_eq!(store.get(a), Err(ShadowsError::Removed { what: "light" }));
        assert_eq!(store.get(c), Ok(&'c'));
        let other = Store::<char>::new("light", 2);
        assert_eq!(other.get(b), Err(ShadowsError::OfAnother { what: "light" }));
    }
}
