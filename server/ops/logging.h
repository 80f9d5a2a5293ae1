// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_OPS_LOGGING_H_
#define POSESPACE_OPS_LOGGING_H_

#include <string>
#include <string_view>

namespace posespace {

// Logs go to stderr, one line each: time, level, event, then key=value pairs.
// `level` is debug, info, warn, error or off.
void SetUpLogging(const std::string& level);

// A value for a key=value pair: as it is when it is one plain word, else quoted, with quotes,
// backslashes and control characters escaped, so that no caller can forge a log line.
std::string LogValue(std::string_view text);

}  // namespace posespace

#endif  // POSESPACE_OPS_LOGGING_H_
