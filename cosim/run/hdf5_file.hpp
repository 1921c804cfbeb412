#pragma once
#include <hdf5.h>

#include <filesystem>
#include <string>
#include <vector>

#include "cosim/run/new_file.hpp"

namespace cosim {
/// Shape of an array, or of one row of a growing array.
using Shape = std::vector<hsize_t>;

/// An HDF5 file that grows in memory and is written by `commit`: the library itself crashes on a disk that is full. Every failure is an
/// InputError naming the file and the reason.
class Hdf5Writer {
 public:
  explicit Hdf5Writer(const std::filesystem::path& name);
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;
  /// An array whose name may hold folders, a/b/c: they are made.
  void write(const std::string& array, const std::vector<double>& values, const Shape& shape);
  void write(const std::string& array, const std::vector<int>& values, const Shape& shape);
  /// Text as an attribute of the file.
  void write_text(const std::string& attribute, const std::string& text) { write_text("/", attribute, text); }
  /// Text as an attribute of an array.
  void write_text(const std::string& array, const std::string& attribute, const std::string& text);
  /// Adds a row at the end of a growing array, which the first row creates.
  void append(const std::string& array, const std::vector<double>& row, const Shape& row_shape);
  void append(const std::string& array, const std::vector<float>& row, const Shape& row_shape);
  void append(const std::string& array, const std::vector<int>& row, const Shape& row_shape);
  /// Takes the room on the disk that the file needs so far, so that a full one shows now and not at the end.
  void reserve();
  void commit();

 private:
  void write(const std::string& array, const void* values, hid_t type, const Shape& shape);
  void append(const std::string& array, const void* row, hid_t type, const Shape& row_shape);
  void require(bool success) const;
  TextFile file_;
  hid_t id_ = -1;
};

/// An HDF5 file being read. Every failure is an InputError naming the file and what is missing.
class Hdf5Reader {
 public:
  explicit Hdf5Reader(const std::filesystem::path& name);
  ~Hdf5Reader();
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;
  Shape shape(const std::string& array) const;
  std::vector<double> read_reals(const std::string& array) const;
  std::vector<int> read_ints(const std::string& array) const;
  bool holds(const std::string& name) const;                          ///< an array or folder
  std::vector<std::string> members(const std::string& folder) const;  ///< by name; none where there is no such folder
  std::string read_text(const std::string& attribute) const { return read_text("/", attribute); }
  std::string read_text(const std::string& array, const std::string& attribute) const;
  /// Row `index` of a growing array.
  std::vector<double> read_row(const std::string& array, int index) const;

 private:
  template <class T>
  std::vector<T> read(const std::string& array, hid_t type, int row) const;
  [[noreturn]] void fail(const std::string& what) const;
  std::string name_;
  hid_t id_ = -1;
};
}  // namespace cosim
