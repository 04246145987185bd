//! Pictures from numpy arrays and back.

use numpy::ndarray::Dimension;
use numpy::{
    Element, PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray, PyReadonlyArray2,
    PyReadonlyArray3, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use rsapien_vision::{ColorView, GrayImage, GrayView, ImageError, Picture, PixelLayout};
use std::borrow::Cow;

use crate::errors::value_error;

/// A picture borrowed from numpy for the time of a detection.
pub(crate) enum Borrowed<'py> {
    Gray(PyReadonlyArray2<'py, u8>),
    Gray16(PyReadonlyArray2<'py, u16>),
    Color(PyReadonlyArray3<'py, u8>, PixelLayout),
}

/// Its pixels, which any thread may read. Those that follow each other without a gap are read where they stand.
pub(crate) struct Pixels<'a> {
    values: Values<'a>,
    width: usize,
    height: usize,
}

enum Values<'a> {
    Gray(Cow<'a, [u8]>),
    Gray16(Cow<'a, [u16]>),
    Color(Cow<'a, [u8]>, PixelLayout),
}

impl<'py> Borrowed<'py> {
    pub(crate) fn new(image: &Bound<'py, PyAny>) -> PyResult<Borrowed<'py>> {
        if let Ok(array) = image.extract::<PyReadonlyArray2<'py, u8>>() {
            return Ok(Borrowed::Gray(array));
        }
        if let Ok(array) = image.extract::<PyReadonlyArray2<'py, u16>>() {
            return Ok(Borrowed::Gray16(array));
        }
        if let Ok(array) = image.extract::<PyReadonlyArray3<'py, u8>>() {
            return match array.shape().get(2) {
                Some(3) => Ok(Borrowed::Color(array, PixelLayout::Rgb)),
                Some(4) => Ok(Borrowed::Color(array, PixelLayout::Rgba)),
                _ => Err(wrong_array(image)),
            };
        }
        Err(wrong_array(image))
    }

    pub(crate) fn pixels(&self) -> Pixels<'_> {
        let (shape, values) = match self {
            Borrowed::Gray(array) => (array.shape(), Values::Gray(in_rows(array))),
            Borrowed::Gray16(array) => (array.shape(), Values::Gray16(in_rows(array))),
            Borrowed::Color(array, layout) => {
                (array.shape(), Values::Color(in_rows(array), *layout))
            }
        };
        Pixels { values, width: shape[1], height: shape[0] }
    }
}

fn wrong_array(image: &Bound<'_, PyAny>) -> PyErr {
    let got = match image.cast::<PyUntypedArray>() {
        Ok(array) => format!("an array of shape {:?} and type {}", array.shape(), array.dtype()),
        Err(_) => format!("{}", image.get_type()),
    };
    PyTypeError::new_err(format!(
        "image must be a numpy array of type uint8 and shape (height, width), (height, width, 3) for RGB or (height, width, 4) for RGBA, or of type uint16 and shape (height, width), not {got}"
    ))
}

/// The values where they stand, if row follows row without a gap, and a copy otherwise. `as_slice` alone would also give
/// those of an array whose columns do.
fn in_rows<'a, T: Element + Copy, D: Dimension>(
    array: &'a PyReadonlyArray<'_, T, D>,
) -> Cow<'a, [T]> {
    let in_place = array.is_c_contiguous().then(|| array.as_slice().ok()).flatten();
    in_place.map_or_else(|| array.as_array().iter().copied().collect(), Cow::Borrowed)
}

impl Pixels<'_> {
    /// Gives the picture in grey to `look`.
    pub(crate) fn with_gray<T>(
        &self,
        look: impl FnOnce(&GrayView<'_>) -> T,
    ) -> Result<T, ImageError> {
        let (width, height) = (self.width, self.height);
        Ok(match &self.values {
            Values::Gray(values) => look(&GrayView::new(values, width, height, width)?),
            Values::Gray16(values) => {
                look(&GrayImage::from_gray16(values, width, height, width)?.view())
            }
            Values::Color(values, layout) => {
                let stride = width.saturating_mul(layout.bytes_per_pixel());
                look(&ColorView::new(values, width, height, stride, *layout)?.to_gray().view())
            }
        })
    }

    /// A copy in colour.
    pub(crate) fn to_picture(&self) -> PyResult<Picture> {
        match &self.values {
            Values::Color(values, layout) => {
                let pixels = values.chunks_exact(layout.bytes_per_pixel());
                let rgb = pixels.flat_map(|pixel| pixel[..3].iter().copied()).collect();
                Picture::new(rgb, self.width, self.height).map_err(value_error)
            }
            _ => self.with_gray(Picture::from_gray).map_err(value_error),
        }
    }
}

/// The picture as an array of shape (height, width, 3).
pub(crate) fn to_numpy<'py>(
    py: Python<'py>,
    picture: &Picture,
) -> PyResult<Bound<'py, PyArray3<u8>>> {
    PyArray1::from_slice(py, picture.rgb()).reshape([picture.height(), picture.width(), 3])
}
