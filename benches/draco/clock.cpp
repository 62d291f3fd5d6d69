// Draco's mesh coder at level 10, one step at a time for `cargo bench --bench intra` to time by turns
// with ours: draco_clock FILE.obj BITS reads the mesh, then for every line of standard input, `encode`
// or `decode`, does that once and prints the bytes of the stream and the nanoseconds that the thread
// worked. Files, start of the process and building of the input are in neither.

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/io/mesh_io.h>
#include <time.h>

#include <cstdlib>
#include <iostream>
#include <string>

static long long thread_nanoseconds() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return time.tv_sec * 1000000000LL + time.tv_nsec;
}

static bool encode(const draco::Mesh &mesh, int bits, draco::EncoderBuffer *bytes) {
  draco::Encoder encoder;
  encoder.SetSpeedOptions(0, 0);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, bits);
  bytes->Clear();
  return encoder.EncodeMeshToBuffer(mesh, bytes).ok();
}

static bool decode(const draco::EncoderBuffer &bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  draco::Mesh mesh;
  return decoder.DecodeBufferToGeometry(&buffer, &mesh).ok();
}

int main(int count, char **arguments) {
  if (count != 3) return 2;
  auto read = draco::ReadMeshFromFile(arguments[1]);
  if (!read.ok()) return 1;
  const auto mesh = std::move(read).value();
  const int bits = std::atoi(arguments[2]);
  draco::EncoderBuffer bytes;
  if (!encode(*mesh, bits, &bytes)) return 1;
  for (std::string step; std::getline(std::cin, step);) {
    const long long start = thread_nanoseconds();
    const bool done = step == "encode" ? encode(*mesh, bits, &bytes) : decode(bytes);
    const long long nanoseconds = thread_nanoseconds() - start;
    if (!done) return 1;
    std::cout << bytes.size() << ' ' << nanoseconds << std::endl;
  }
}
