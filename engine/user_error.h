#pragma once

#include <stdexcept>
#include <string>

namespace planecast::engine {

/// Bad input or usage: one line naming the file and the reason. Thrown at the file and command-line
/// edges, caught once in main, which prints it and exits with 2.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace planecast::engine
