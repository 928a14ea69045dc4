// The process in which laws that are written in Python run.
#pragma once

#include <sys/types.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kerf {

/// Speaks with one Python process over a socket: first a description of the laws of a file as JSON, then requests of
/// numbers. A law that throws in Python, or a process that ends, is a std::runtime_error with the place in the file.
class PrototypeHost {
 public:
  /// Starts Python for a file. Throws std::runtime_error, with what Python says, where the file cannot be read as laws.
  explicit PrototypeHost(const std::string& file);
  ~PrototypeHost();
  PrototypeHost(const PrototypeHost&) = delete;
  PrototypeHost& operator=(const PrototypeHost&) = delete;

  /// What the laws of the file declare, a list.
  const nlohmann::json& laws() const { return laws_; }
  /// Makes an object of the law in place `law` of laws(), with its parameters by name; returns its number.
  int make(int law, const nlohmann::json& parameters);
  /// Computes a block. Returns as many numbers as the law of the object gives.
  std::vector<double> compute(int object, const std::vector<double>& numbers);

 private:
  void end();
  std::string request(const nlohmann::json& head, const std::vector<double>& numbers);
  void send_all(const void* data, std::size_t size);
  void receive_all(void* data, std::size_t size);

  std::string file_, at_work_;  // the latter for reports of a law that never ends
  pid_t process_ = -1;
  int socket_ = -1;
  nlohmann::json laws_;
};

}  // namespace kerf
