#pragma once
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace cosim {
/// A file that takes its name only when it is complete: it grows beside its place under a temporary name, and nothing is left of it
/// if `commit` is not reached.
class NewFile {
 public:
  explicit NewFile(std::filesystem::path name);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  const std::filesystem::path& name() const { return name_; }
  const std::filesystem::path& temporary() const { return temporary_; }
  /// Gives the file its name.  @throws InputError with the reason if that fails
  void commit();

 private:
  std::filesystem::path name_, temporary_;
};

/// Text or bytes, written bit by bit to a NewFile. Every failure to write is an InputError naming the file and the reason.
class TextFile {
 public:
  explicit TextFile(const std::filesystem::path& name);
  ~TextFile();
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  void write(std::string_view text);
  /// Makes sure that the disk has room for so many bytes in all.
  void reserve(std::size_t bytes);
  void commit();
  const std::filesystem::path& name() const { return file_.name(); }

 private:
  NewFile file_;
  std::FILE* stream_;
};

/// The whole text at once, whole or not at all.
void write_text(const std::filesystem::path& name, std::string_view text);

/// Writes nothing: to know before long work that its file can be written.  @throws InputError with the reason if it cannot
void require_writable(const std::filesystem::path& name);

/// Makes a folder and those above it.  @throws InputError with the reason if it cannot be made or written in
void make_folder(const std::filesystem::path& folder);
}  // namespace cosim
