//! Streams from servers that behave badly.

use std::io::Read;
use std::net::TcpListener;
use std::sync::mpsc;

use super::super::tests::jpeg;
use super::*;

/// What a server does with a connection.
type Serving = Box<dyn FnOnce(&mut TcpStream) + Send>;

/// Serves one connection after the other.
fn serve(connections: Vec<Serving>) -> HttpAddress {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    thread::spawn(move || {
        for connection in connections {
            let (mut stream, _) = listener.accept().unwrap();
            let mut request = [0; 2000];
            let count = stream.read(&mut request).unwrap();
            assert!(
                request[..count].starts_with(b"GET /video?size=1 HTTP/1.1\r\nHost: 127.0.0.1:")
            );
            connection(&mut stream);
        }
    });
    format!("http://{address}/video?size=1").parse().unwrap()
}

/// A part with its head, with or without its length.
fn part(width: usize, tells_length: bool) -> Vec<u8> {
    let picture = jpeg(width, 8);
    let length = format!("Content-Length: {}\r\n", picture.len());
    let length = if tells_length { length.as_str() } else { "" };
    let mut part = format!("--edge\r\nContent-Type: image/jpeg\r\n{length}\r\n").into_bytes();
    part.extend(picture);
    part.extend(b"\r\n");
    part
}

fn chunked(bytes: &[u8]) -> Vec<u8> {
    let mut chunks = Vec::new();
    for chunk in bytes.chunks(100) {
        chunks.extend(format!("{:X}\r\n", chunk.len()).into_bytes());
        chunks.extend(chunk);
        chunks.extend(b"\r\n");
    }
    chunks
}

const HEAD: &[u8] =
    b"HTTP/1.0 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=edge\r\n\r\n";
const HEAD_CHUNKED: &[u8] =
    b"HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=edge\r\nTransfer-Encoding: chunked\r\n\r\n";

#[test]
fn a_stream_that_stalls_closes_and_refuses_goes_on_when_it_comes_back() {
    let (end, ended) = mpsc::channel::<()>();
    let address = serve(vec![
        Box::new(|stream| {
            stream.write_all(HEAD).unwrap();
            stream.write_all(&part(11, true)).unwrap();
            stream.write_all(&part(12, false)).unwrap();
        }),
        Box::new(|stream| stream.write_all(b"HTTP/1.1 503 Busy\r\n\r\n").unwrap()),
        Box::new(move |stream| {
            stream.write_all(HEAD_CHUNKED).unwrap();
            stream.write_all(&chunked(&part(13, false))).unwrap();
            // Silent until the test is over.
            let _ = ended.recv();
        }),
    ]);
    let options = HttpOptions {
        silence: Duration::from_millis(150),
        retry_first: Duration::from_millis(10),
        ..HttpOptions::default()
    };
    let mut stream = HttpStream::new(address, options, SourceOptions::default());
    let mut told = Vec::new();
    while told.len() < 7 {
        told.push(match stream.next_frame().unwrap() {
            Next::Frame(frame) => format!("{} {}", frame.number, frame.gray.width()),
            Next::Trouble(trouble) => trouble.to_string(),
            Next::End => "the end".to_owned(),
        });
    }
    drop(end);
    let expected =
        ["0 11", "1 12", "closed", "status 503", "connected again", "2 13", "nothing came"];
    for (told, expected) in told.iter().zip(expected) {
        assert!(told.contains(expected), "{told:?} is not {expected:?}");
    }
}

#[test]
fn a_first_connection_that_fails_is_an_error_that_names_the_address() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let text = format!("http://{}/cam", listener.local_addr().unwrap());
    drop(listener);
    let mut stream =
        HttpStream::new(text.parse().unwrap(), HttpOptions::default(), SourceOptions::default());
    let error = stream.next_frame().unwrap_err().to_string();
    assert!(error.contains(&text) && error.contains("refused"), "{error}");
}

#[test]
fn addresses_are_read_or_refused_without_repeating_a_password() {
    for (text, read) in [
        ("http://cam", "http://cam:80/"),
        ("http://cam:8080/video?a=b:c#d", "http://cam:8080/video?a=b:c"),
        ("http://[::1]:81?x", "http://[::1]:81/?x"),
        ("http://[::1]/y", "http://[::1]:80/y"),
    ] {
        assert_eq!(text.parse::<HttpAddress>().unwrap().to_string(), read);
    }
    for (text, words) in [
        ("https://cam/", "ffmpeg"),
        ("http://", "HOST:PORT"),
        ("http://cam:0/", "HOST:PORT"),
        ("http://cam:http/", "port"),
        ("http://me:secret@cam/", "passwords"),
        ("http://cam/a b", "%XX"),
        ("http://cam/a\r\nX: y", "%XX"),
    ] {
        let refused = text.parse::<HttpAddress>().unwrap_err().to_string();
        assert!(refused.contains(words) && !refused.contains("secret"), "{refused}");
    }
}
