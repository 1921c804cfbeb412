#include "cosim/run/hdf5_file.hpp"

#include <functional>
#include <numeric>
#include <utility>

#include "tape/core/error.hpp"
#include "tape/core/hdf5_handle.hpp"

namespace cosim {
namespace {
hsize_t product(const Shape& shape) { return std::accumulate(shape.begin(), shape.end(), hsize_t{1}, std::multiplies<>()); }

/// Layout of a growing array: chunks of one row, packed.
hid_t row_layout(const Shape& row_shape) {
  const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
  Shape chunk = row_shape;
  chunk.insert(chunk.begin(), 1);
  if (product(chunk) < 64) chunk[0] = 256;
  H5Pset_chunk(layout, static_cast<int>(chunk.size()), chunk.data());
  if (product(row_shape) >= 64) {
    H5Pset_shuffle(layout);
    H5Pset_deflate(layout, 1);
  }
  return layout;
}
/// Layout of an array that is written at once: packed if it holds much.
hid_t whole_layout(const Shape& shape) {
  const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
  if (product(shape) < 1024) return layout;
  H5Pset_chunk(layout, static_cast<int>(shape.size()), shape.data());
  H5Pset_shuffle(layout);
  H5Pset_deflate(layout, 6);
  return layout;
}
/// An array, with the folders in its name.
hid_t create(hid_t file, const std::string& array, hid_t type, hid_t space, hid_t layout) {
  const tape::Hdf5Handle folders(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(folders, 1);
  return H5Dcreate2(file, array.c_str(), type, space, folders, layout, H5P_DEFAULT);
}
}  // namespace

Hdf5Writer::Hdf5Writer(const std::filesystem::path& name) : file_(name) {
  tape::silence_hdf5();
  constexpr std::size_t kGrowth = 1 << 20;  // [bytes]
  const tape::Hdf5Handle memory(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(memory, kGrowth, false);
  id_ = H5Fcreate(file_.name().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, memory);
  require(id_ >= 0);
}

Hdf5Writer::~Hdf5Writer() {
  if (id_ >= 0) H5Fclose(id_);
}

void Hdf5Writer::require(bool success) const {
  if (!success) throw tape::InputError("cannot write " + file_.name().string() + ": the HDF5 library refuses, perhaps for lack of memory");
}

void Hdf5Writer::write(const std::string& array, const void* values, hid_t type, const Shape& shape) {
  const tape::Hdf5Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const tape::Hdf5Handle layout(whole_layout(shape), H5Pclose);
  const tape::Hdf5Handle data(create(id_, array, type, space, layout), H5Dclose);
  require(data >= 0);
  if (product(shape) > 0) require(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
}

void Hdf5Writer::append(const std::string& array, const void* row, hid_t type, const Shape& row_shape) {
  Shape size = row_shape, start(row_shape.size() + 1, 0);
  if (H5Lexists(id_, array.c_str(), H5P_DEFAULT) <= 0) {
    Shape unlimited = row_shape;
    unlimited.insert(unlimited.begin(), H5S_UNLIMITED);
    size.insert(size.begin(), 0);
    const tape::Hdf5Handle space(H5Screate_simple(static_cast<int>(size.size()), size.data(), unlimited.data()), H5Sclose);
    const tape::Hdf5Handle layout(row_layout(row_shape), H5Pclose);
    const tape::Hdf5Handle data(create(id_, array, type, space, layout), H5Dclose);
    require(data >= 0);
    size = row_shape;
  }
  const tape::Hdf5Handle data(H5Dopen2(id_, array.c_str(), H5P_DEFAULT), H5Dclose);
  size.insert(size.begin(), 0);
  {
    const tape::Hdf5Handle space(H5Dget_space(data), H5Sclose);
    H5Sget_simple_extent_dims(space, size.data(), nullptr);
  }
  start[0] = size[0]++;
  require(H5Dset_extent(data, size.data()) >= 0);
  size[0] = 1;
  const tape::Hdf5Handle space(H5Dget_space(data), H5Sclose),
      memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
  H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr);
  require(H5Dwrite(data, type, memory, space, H5P_DEFAULT, row) >= 0);
}

void Hdf5Writer::write(const std::string& array, const std::vector<double>& values, const Shape& shape) {
  TAPE_CHECK(values.size() == product(shape));
  write(array, values.data(), H5T_NATIVE_DOUBLE, shape);
}
void Hdf5Writer::write(const std::string& array, const std::vector<int>& values, const Shape& shape) {
  TAPE_CHECK(values.size() == product(shape));
  write(array, values.data(), H5T_NATIVE_INT, shape);
}
void Hdf5Writer::append(const std::string& array, const std::vector<double>& row, const Shape& row_shape) {
  TAPE_CHECK(row.size() == product(row_shape));
  append(array, row.data(), H5T_NATIVE_DOUBLE, row_shape);
}
void Hdf5Writer::append(const std::string& array, const std::vector<float>& row, const Shape& row_shape) {
  TAPE_CHECK(row.size() == product(row_shape));
  append(array, row.data(), H5T_NATIVE_FLOAT, row_shape);
}
void Hdf5Writer::append(const std::string& array, const std::vector<int>& row, const Shape& row_shape) {
  TAPE_CHECK(row.size() == product(row_shape));
  append(array, row.data(), H5T_NATIVE_INT, row_shape);
}

void Hdf5Writer::write_text(const std::string& array, const std::string& attribute, const std::string& text) {
  const tape::Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
  H5Tset_size(type, text.size() + 1);
  H5Tset_cset(type, H5T_CSET_UTF8);
  const tape::Hdf5Handle object(H5Oopen(id_, array.c_str(), H5P_DEFAULT), H5Oclose);
  const tape::Hdf5Handle written(H5Acreate2(object, attribute.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  require(written >= 0 && H5Awrite(written, type, text.c_str()) >= 0);
}

void Hdf5Writer::reserve() {
  require(H5Fflush(id_, H5F_SCOPE_LOCAL) >= 0);
  const ssize_t bytes = H5Fget_file_image(id_, nullptr, 0);
  require(bytes > 0);
  file_.reserve(static_cast<std::size_t>(bytes));
}

void Hdf5Writer::commit() {
  reserve();
  std::string image(static_cast<std::size_t>(H5Fget_file_image(id_, nullptr, 0)), '\0');
  require(H5Fget_file_image(id_, image.data(), image.size()) > 0);
  file_.write(image);
  file_.commit();
}

Hdf5Reader::Hdf5Reader(const std::filesystem::path& name) : name_(name.string()) {
  tape::silence_hdf5();
  if (!std::filesystem::exists(name)) throw tape::InputError(name_ + ": there is no such file");
  id_ = H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (id_ < 0) throw tape::InputError(name_ + ": not an HDF5 file, or damaged");
}

Hdf5Reader::~Hdf5Reader() {
  if (id_ >= 0) H5Fclose(id_);
}

void Hdf5Reader::fail(const std::string& what) const { throw tape::InputError(name_ + ": " + what + " is missing or damaged"); }

Shape Hdf5Reader::shape(const std::string& array) const {
  const tape::Hdf5Handle data(H5Dopen2(id_, array.c_str(), H5P_DEFAULT), H5Dclose);
  if (data < 0) fail(array);
  const tape::Hdf5Handle space(H5Dget_space(data), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 1) fail(array);
  Shape shape(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  return shape;
}

template <class T>
std::vector<T> Hdf5Reader::read(const std::string& array, hid_t type, int row) const {
  Shape size = shape(array), start(size.size(), 0);
  const tape::Hdf5Handle data(H5Dopen2(id_, array.c_str(), H5P_DEFAULT), H5Dclose), space(H5Dget_space(data), H5Sclose);
  if (row >= 0) {
    if (static_cast<hsize_t>(row) >= size[0]) fail(array + "[" + std::to_string(row) + "]");
    start[0] = static_cast<hsize_t>(row);
    size[0] = 1;
  }
  H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr);
  const tape::Hdf5Handle memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
  constexpr double kMost = 1e9;  // more stands in no file of ours; a damaged one may claim anything
  if (!(std::accumulate(size.begin(), size.end(), 1.0, std::multiplies<>()) <= kMost)) fail(array);
  std::vector<T> values(product(size));
  if (!values.empty() && H5Dread(data, type, memory, space, H5P_DEFAULT, values.data()) < 0) fail(array);
  return values;
}

std::vector<double> Hdf5Reader::read_reals(const std::string& array) const { return read<double>(array, H5T_NATIVE_DOUBLE, -1); }
std::vector<int> Hdf5Reader::read_ints(const std::string& array) const { return read<int>(array, H5T_NATIVE_INT, -1); }
std::vector<double> Hdf5Reader::read_row(const std::string& array, int index) const {
  return read<double>(array, H5T_NATIVE_DOUBLE, index);
}

bool Hdf5Reader::holds(const std::string& name) const {
  for (std::size_t slash = 0; slash != name.npos;) {  // the library refuses to look into a folder that is not there
    slash = name.find('/', slash + 1);
    if (H5Lexists(id_, name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
  }
  return true;
}

std::vector<std::string> Hdf5Reader::members(const std::string& folder) const {
  std::vector<std::string> names;
  if (!holds(folder)) return names;
  const tape::Hdf5Handle group(H5Gopen2(id_, folder.c_str(), H5P_DEFAULT), H5Gclose);
  if (group < 0) fail("folder " + folder);
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* all) -> herr_t {
    static_cast<std::vector<std::string>*>(all)->emplace_back(name);
    return 0;
  };
  if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names) < 0) fail("folder " + folder);
  return names;
}

std::string Hdf5Reader::read_text(const std::string& array, const std::string& attribute) const {
  const std::string name = array == "/" ? attribute : "attribute " + attribute + " of " + array;
  const tape::Hdf5Handle object(H5Oopen(id_, array.c_str(), H5P_DEFAULT), H5Oclose);
  const tape::Hdf5Handle read(H5Aopen(object, attribute.c_str(), H5P_DEFAULT), H5Aclose);
  if (read < 0) fail(name);
  const tape::Hdf5Handle type(H5Aget_type(read), H5Tclose), space(H5Aget_space(read), H5Sclose);
  constexpr std::size_t kMost = 64'000'000;
  if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) fail(name);
  if (H5Tis_variable_str(type) > 0) {  // as Python's h5py writes text
    char* given = nullptr;
    if (H5Aread(read, type, static_cast<void*>(&given)) < 0 || !given) fail(name);
    std::string text = given;
    H5free_memory(given);
    return text;
  }
  if (H5Tget_size(type) > kMost) fail(name);
  std::string text(H5Tget_size(type), '\0');
  if (H5Aread(read, type, text.data()) < 0) fail(name);
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}
}  // namespace cosim
