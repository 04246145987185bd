use super::*;
use ::image::{ExtendedColorType, ImageFormat, write_buffer_with_format};

fn encoded(format: ImageFormat) -> Vec<u8> {
    let pixels: Vec<u8> = (0..32 * 24 * 3).map(|i| (i * 7 % 251) as u8).collect();
    let mut bytes = Cursor::new(Vec::new());
    write_buffer_with_format(&mut bytes, &pixels, 32, 24, ExtendedColorType::Rgb8, format)
        .expect("an encoder");
    bytes.into_inner()
}

#[test]
fn a_saved_picture_comes_back_the_same() {
    let folder = std::env::temp_dir().join(format!("rsapien-vision-io-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("picture.png");
    let picture = Picture::decode(&encoded(ImageFormat::Bmp)).expect("a picture");
    picture.save_png(&path).expect("saved");
    assert_eq!(Picture::open(&path).expect("read"), picture);
    save_gray_png(&picture.to_gray(), &path).expect("saved");
    assert_eq!(Picture::open(&path).expect("read").to_gray(), picture.to_gray());
    fs::remove_dir_all(&folder).expect("removed");
    assert!(Picture::open(&path).expect_err("gone").to_string().starts_with("cannot read "));
}

#[test]
fn every_truncated_file_is_an_error() {
    for format in [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::Bmp, ImageFormat::Pnm] {
        let whole = encoded(format);
        assert!(Picture::decode(&whole).is_ok(), "{format:?}");
        for length in [0, 1, 2, 8, 20, whole.len() / 3, whole.len() / 2, whole.len() - 20] {
            let error = Picture::decode(&whole[..length]);
            assert!(error.is_err(), "{format:?} cut to {length} of {} bytes was read", whole.len());
        }
    }
}

#[test]
fn content_that_is_no_picture_is_named_so() {
    assert!(matches!(Picture::decode(b"# a text"), Err(PictureError::UnknownFormat)));
    assert!(matches!(Picture::decode(b""), Err(PictureError::UnknownFormat)));
    let gif = Picture::decode(b"GIF89a\x01\0\x01\0").unwrap_err();
    assert_eq!(gif.to_string(), "gif pictures are not read: convert it to png, jpeg, bmp or pnm");
}

#[test]
fn a_head_that_claims_a_huge_size_is_refused_before_anything_is_decoded() {
    // Signature, then an IHDR chunk for 60000 x 60000 RGB; the check value is that of the chunk.
    let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\xea\x60\0\0\xea\x60\x08\x02\0\0\0".to_vec();
    let check = png[12..].iter().fold(u32::MAX, |check, &byte| {
        (0..8).fold(check ^ u32::from(byte), |check, _| {
            (check >> 1) ^ (0xEDB8_8320 & (check & 1).wrapping_neg())
        })
    });
    png.extend((!check).to_be_bytes());
    png.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e");
    match Picture::decode(&png) {
        Err(PictureError::Size(error)) => {
            assert_eq!(error, ImageError::TooLarge { width: 60_000, height: 60_000 });
        }
        other => panic!("{other:?}"),
    }
    let pnm = Picture::decode(b"P6 0 7 255\n");
    assert!(pnm.is_err(), "{pnm:?}");
}

#[test]
fn broken_bytes_never_panic() {
    for format in [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::Bmp, ImageFormat::Pnm] {
        let whole = encoded(format);
        for at in (0..whole.len()).step_by(7) {
            let mut broken = whole.clone();
            broken[at] ^= 0xA5;
            if let Ok(picture) = Picture::decode(&broken) {
                assert_eq!(picture.rgb().len(), picture.width() * picture.height() * 3);
            }
        }
    }
}
