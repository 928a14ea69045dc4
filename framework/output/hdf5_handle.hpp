// Closes what HDF5's library has opened, and sets attributes of it.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <string>

namespace kerf::hdf5 {

/// One open object of HDF5's library; negative where it could not be opened.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }
  bool good() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Sets an attribute of an open object, new or there already. False where that fails.
bool put(hid_t object, const char* name, std::int64_t value);
bool put(hid_t object, const char* name, double value);
bool put(hid_t object, const char* name, const std::string& text);

}  // namespace kerf::hdf5
