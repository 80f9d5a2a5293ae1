// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_OPS_PORT_FILE_H_
#define POSESPACE_OPS_PORT_FILE_H_

#include <string>

#include "geometry/result.h"

namespace posespace {

// Writes the port as a line of its own into `path`, whole or not at all: a reader that polls for
// the file never sees half a number.  Fails with kInvalidOption.
Result<void> WritePortFile(const std::string& path, int port);

}  // namespace posespace

#endif  // POSESPACE_OPS_PORT_FILE_H_
