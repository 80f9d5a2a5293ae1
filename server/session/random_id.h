// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_RANDOM_ID_H_
#define POSESPACE_SESSION_RANDOM_ID_H_

#include <string>

namespace posespace {

// 128 unguessable bits as 32 lower-case hexadecimal digits.  Call from any thread.
std::string RandomId();

}  // namespace posespace

#endif  // POSESPACE_SESSION_RANDOM_ID_H_
