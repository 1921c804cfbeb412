#include "cosim/run/new_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "tape/core/error.hpp"

namespace cosim {
namespace {
[[noreturn]] void fail(const std::filesystem::path& name, int error) {
  throw tape::InputError("cannot write " + name.string() + ": " + std::strerror(error));
}
}  // namespace

NewFile::NewFile(std::filesystem::path name) : name_(std::move(name)), temporary_(name_) {
  temporary_.replace_filename("." + std::to_string(getpid()) + "." + name_.filename().string());
}

NewFile::~NewFile() {
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void NewFile::commit() {
  std::error_code error;
  std::filesystem::rename(temporary_, name_, error);
  if (error) fail(name_, error.value());
}

TextFile::TextFile(const std::filesystem::path& name) : file_(name), stream_(std::fopen(file_.temporary().c_str(), "wb")) {
  if (!stream_) fail(name, errno);
}

TextFile::~TextFile() {
  if (stream_) std::fclose(stream_);
}

void TextFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stream_) != text.size()) fail(file_.name(), errno);
}

void TextFile::reserve(std::size_t bytes) {
  if (const int error = posix_fallocate(fileno(stream_), 0, static_cast<off_t>(bytes))) fail(file_.name(), error);
}

void TextFile::commit() {
  std::FILE* stream = std::exchange(stream_, nullptr);
  const bool flushed = std::fflush(stream) == 0 && fsync(fileno(stream)) == 0;
  const int error = errno;
  if (std::fclose(stream) != 0 || !flushed) fail(file_.name(), flushed ? errno : error);
  file_.commit();
}

void write_text(const std::filesystem::path& name, std::string_view text) {
  TextFile file(name);
  file.write(text);
  file.commit();
}

void require_writable(const std::filesystem::path& name) { const TextFile empty(name); }

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && !std::filesystem::is_directory(folder)) error = std::make_error_code(std::errc::not_a_directory);
  if (error) throw tape::InputError("cannot make the folder " + folder.string() + ": " + error.message());
  if (access(folder.c_str(), W_OK) != 0)
    throw tape::InputError("cannot write in the folder " + folder.string() + ": " + std::strerror(errno));
}
}  // namespace cosim
