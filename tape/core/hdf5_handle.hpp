#pragma once
#include <hdf5.h>

namespace tape {
/// Closes an object of the HDF5 library when it goes out of scope; converts to its id.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// The library prints its own stack of errors otherwise; ours name the file.
inline void silence_hdf5() {
  H5dont_atexit();  // its clean-up crashes where a file could not be closed for want of space
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}
}  // namespace tape
