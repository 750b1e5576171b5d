//! Pictures inside of charts. Their pixels are kept beside the texture, so that exports can draw them without a graphics card.

use std::sync::{Arc, Weak};

use egui::{ColorImage, Context, Id, TextureHandle, TextureId, TextureOptions};

/// A texture with its pixels.
#[derive(Clone)]
pub struct Texture {
    handle: TextureHandle,
    image: Arc<ColorImage>,
}

impl std::fmt::Debug for Texture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Texture").field("size", &self.image.size).finish_non_exhaustive()
    }
}

/// Pixels of all textures that exist.
#[derive(Clone, Default)]
struct Known(Vec<(TextureId, Weak<ColorImage>)>);

fn key() -> Id {
    Id::unique("pixels of textures")
}

impl Texture {
    /// Gives a picture to the window.
    #[must_use]
    pub fn new(ctx: &Context, name: &str, image: ColorImage) -> Self {
        let image = Arc::new(image);
        let handle = ctx.load_texture(name, image.clone(), TextureOptions::LINEAR);
        ctx.data_mut(|data| {
            let known = data.get_temp_mut_or_default::<Known>(key());
            known.0.retain(|(_, image)| image.strong_count() > 0);
            known.0.push((handle.id(), Arc::downgrade(&image)));
        });
        Self { handle, image }
    }

    /// Id of the texture in meshes.
    #[must_use]
    pub fn id(&self) -> TextureId {
        self.handle.id()
    }

    /// Pixels of the texture.
    #[must_use]
    pub fn image(&self) -> &ColorImage {
        &self.image
    }
}

/// Pixels of the textures that exist.
pub(super) fn known(ctx: &Context) -> Vec<(TextureId, Arc<ColorImage>)> {
    let known = ctx.data(|data| data.get_temp::<Known>(key())).unwrap_or_default();
    known.0.into_iter().filter_map(|(id, image)| Some((id, image.upgrade()?))).collect()
}
