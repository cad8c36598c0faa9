//! Which format a map gets: the adapter is asked first.

use crate::ShadowError;
use umbrage_core::technique::Storage;

/// A format and why it was taken.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenFormat {
    /// What was settled on; never `Auto`.
    pub storage: Storage,
    /// The same as `wgpu` calls it.
    pub format: wgpu::TextureFormat,
    /// One clause for people.
    pub why: String,
}

/// What `auto` takes, best first: a depth texture where there is one to draw to and to sample, else distance in colour.
pub const BY_PRECISION: [Storage; 6] = [
    Storage::Depth32Float,
    Storage::Depth24,
    Storage::Depth16,
    Storage::R32Float,
    Storage::Packed3,
    Storage::Packed2,
];

/// The depth buffer of maps that are colour.
pub const SCRATCH_DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// How peeled layers are kept.
pub const PEEL_STORAGE: Storage = Storage::Depth32Float;

/// The same as `wgpu` calls it.
pub const PEEL_DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The format of a storage, `None` for `auto`.
pub fn format_of(storage: Storage) -> Option<wgpu::TextureFormat> {
    match storage {
        Storage::Auto => None,
        Storage::Depth16 => Some(wgpu::TextureFormat::Depth16Unorm),
        Storage::Depth24 => Some(wgpu::TextureFormat::Depth24Plus),
        Storage::Depth32Float => Some(wgpu::TextureFormat::Depth32Float),
        Storage::R32Float => Some(wgpu::TextureFormat::R32Float),
        Storage::Packed1 | Storage::Packed2 | Storage::Packed3 => Some(wgpu::TextureFormat::Rgba8Unorm),
    }
}

/// What an adapter lacks for shadow maps of this format; `None` when it has all.
pub fn lacks(usages: wgpu::TextureUsages) -> Option<&'static str> {
    if !usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT) {
        Some("drawing to it")
    } else if !usages.contains(wgpu::TextureUsages::TEXTURE_BINDING) {
        Some("sampling it")
    } else {
        None
    }
}

/// Chooses the format for `asked`. `usages_of` says what the adapter allows for a format:
/// `|f| adapter.get_texture_format_features(f).allowed_usages`.
///
/// # Errors
/// [`ShadowError::Format`] when the adapter lacks what was asked for; it names those that it has.
pub fn choose_format(
    asked: Storage,
    usages_of: impl Fn(wgpu::TextureFormat) -> wgpu::TextureUsages,
) -> Result<ChosenFormat, ShadowError> {
    let lacks_of = |storage| format_of(storage).map_or(Some("a format"), |format| lacks(usages_of(format)));
    let available: Vec<Storage> = BY_PRECISION.into_iter().filter(|s| lacks_of(*s).is_none()).collect();
    let chosen = if asked == Storage::Auto { available.first().copied() } else { Some(asked) };
    let refused = |storage: Storage, lacks| ShadowError::Format {
        storage: storage.row().id,
        lacks,
        available: available.iter().map(|s| s.row().id).collect::<Vec<_>>().join(", "),
    };
    let Some(storage) = chosen else { return Err(refused(asked, "every format")) };
    if let Some(lacks) = lacks_of(storage) {
        return Err(refused(storage, lacks));
    }
    let format = format_of(storage).ok_or_else(|| refused(storage, "a format"))?;
    let why = if asked == Storage::Auto {
        "the most precise that this adapter draws to and compares with".to_owned()
    } else {
        "asked for".to_owned()
    };
    Ok(ChosenFormat { storage, format, why })
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::{TextureFormat, TextureUsages};

    fn all(_: TextureFormat) -> TextureUsages {
        TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING
    }

    #[test]
    fn auto_takes_the_best_that_there_is() {
        let chosen = |usages: fn(TextureFormat) -> TextureUsages| {
            choose_format(Storage::Auto, usages).map(|c| c.storage)
        };
        assert_eq!(chosen(all), Ok(Storage::Depth32Float));
        assert_eq!(
            chosen(|f| if f == TextureFormat::Depth32Float { TextureUsages::COPY_SRC } else { all(f) }),
            Ok(Storage::Depth24)
        );
        assert_eq!(
            chosen(|f| if f == TextureFormat::Depth16Unorm {
                all(f)
            } else {
                TextureUsages::RENDER_ATTACHMENT
            }),
            Ok(Storage::Depth16)
        );
        assert!(chosen(|_| TextureUsages::empty()).is_err());
    }

    #[test]
    fn a_format_that_is_lacking_is_refused_with_the_others_named() {
        let without16 =
            |f| if f == TextureFormat::Depth16Unorm { TextureUsages::TEXTURE_BINDING } else { all(f) };
        let message = choose_format(Storage::Depth16, without16).expect_err("lacking").to_string();
        assert!(message.contains("depth16") && message.contains("drawing to it"), "{message}");
        assert!(message.contains("depth32f, depth24"), "{message}");
    }
}
