//! A small writer of GLB files, so that a fresh clone can test the loader without any file.
