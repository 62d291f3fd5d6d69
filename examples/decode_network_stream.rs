//! Decodes bytes as they arrive: `cargo run --release --example decode_network_stream [FILE.knm]`.
//!
//! A thread serves the file over TCP in small pieces; the other side decodes each frame as soon as
//! its last byte is there. Without an argument a short sequence of the performer is served.

use anyhow::{Result, bail};
use kn_codec::{Encoder, EncoderConfig, FrameInfo, Limits, Progress, StreamDecoder};
use kn_mesh::Mesh;
use kn_performer::{Performer, PerformerConfig};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::thread;

fn main() -> Result<()> {
    let stream = match std::env::args_os().nth(1) {
        Some(path) => std::fs::read(path)?,
        None => performer_stream()?,
    };
    let listener = TcpListener::bind(("127.0.0.1", 0))?;
    let address = listener.local_addr()?;
    let server = thread::spawn(move || serve(&listener, &stream));
    receive(TcpStream::connect(address)?)?;
    match server.join() {
        Ok(served) => Ok(served?),
        Err(_) => bail!("the server thread panicked"),
    }
}

/// Sends the stream in pieces that have nothing to do with its units.
fn serve(listener: &TcpListener, stream: &[u8]) -> std::io::Result<()> {
    let (mut connection, _) = listener.accept()?;
    connection.set_nodelay(true)?;
    for piece in stream.chunks(1_000) {
        connection.write_all(piece)?;
    }
    Ok(())
}

/// Decodes what comes. What arrives from a network is not trusted: the decoder gets limits.
fn receive(mut connection: TcpStream) -> Result<()> {
    let limits = Limits { max_vertices: 100_000, max_faces: 200_000, ..Limits::default() };
    let mut decoder = StreamDecoder::new(limits);
    let mut mesh = Mesh::default();
    let mut buffer = [0; 1_500];
    let mut received = 0;
    loop {
        match decoder.poll(&mut mesh)? {
            Progress::Frame(frame) => show(received, &frame),
            Progress::End => return Ok(()),
            Progress::NeedBytes(_) => match connection.read(&mut buffer)? {
                0 => bail!("the connection was closed in the middle of the stream"),
                count => {
                    received += count;
                    decoder.push(&buffer[..count]);
                }
            },
        }
    }
}

/// Prints the frame; a player would draw it.
fn show(received: usize, frame: &FrameInfo) {
    let FrameInfo { index, kind, vertices, .. } = frame;
    println!("after {received:6} bytes: frame {index}, {kind:?}, {vertices} vertices");
}

fn performer_stream() -> Result<Vec<u8>> {
    let config = PerformerConfig { vertices: 5_000, ..PerformerConfig::default() };
    let performer = Performer::new(config)?;
    let config = EncoderConfig::default().with_nodes(100).with_group_length(4);
    let mut encoder = Encoder::new(Vec::new(), config)?;
    for index in 0..8 {
        encoder.push(&performer.frame(index))?;
    }
    Ok(encoder.finish()?.writer)
}
