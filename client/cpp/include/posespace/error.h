// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_ERROR_H_
#define POSESPACE_ERROR_H_

#include <chrono>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace posespace {

// What kind of refusal an Error is; the Python client has a class for each.
enum class ErrorCode {
  kInvalidArgument,  // an argument makes no sense; the message names it and the limit it breaks
  kInvalidDrawing,   // a picture or polygon that no outline can be made of
  kNotFound,         // no such session, drawing, revision or build
  kAlreadyExists,    // the id is taken, with other content
  kNotBuilt,         // the session has to be built first; with reason NO_SHAPES it needs a drawing
  kConflict,         // somebody else changed the session since it was read
  kResourceExhausted,  // a limit or a queue of the service is full, or a request is too large
  kUnavailable,        // the service cannot be reached, has ended, or is about to
  kDeadlineExceeded,   // no answer within the timeout
  kCancelled,          // the call or the build was cancelled
  kUnauthenticated,    // the service does not know who is calling
  kPermissionDenied,   // the caller may not do this
  kInternal,           // a bug in the service
  kUnknown,            // none of these
};

// "NotFound": for logs.
std::string_view Name(ErrorCode code);

// What every call throws when it is refused.  A value: copy and keep it freely.
//
//   try {
//     session.PutShape("jump", posespace::ImageSource{posespace::ReadFile("jump.png")});
//   } catch (const posespace::Error& error) {
//     std::cerr << error.what();        // names the drawing, the point and the limit
//     if (error.reason() == "OUTLINE_EMPTY") ...
//   }
//
// What a moment's wait may mend (a full queue, say) has been tried again until the client's timeout
// before it is thrown.
class Error : public std::runtime_error {
 public:
  using Fields = std::map<std::string, std::string>;
  using Seconds = std::chrono::duration<double>;

  explicit Error(ErrorCode code, const std::string& message, std::string reason = {},
                 Fields fields = {}, std::optional<Seconds> retry_after = {})
      : std::runtime_error(message),
        code_(code),
        reason_(std::move(reason)),
        fields_(std::move(fields)),
        retry_after_(retry_after) {}

  ErrorCode code() const { return code_; }

  // Stable name of the cause, such as "SESSION_NOT_FOUND"; empty when the cause lies outside the
  // service.
  const std::string& reason() const { return reason_; }

  // Path of each field at fault -> what is wrong with it.
  const Fields& fields() const { return fields_; }

  // After which another try may succeed; none when trying again is no use.
  std::optional<Seconds> retry_after() const { return retry_after_; }

 private:
  ErrorCode code_;
  std::string reason_;
  Fields fields_;
  std::optional<Seconds> retry_after_;
};

}  // namespace posespace

#endif  // POSESPACE_ERROR_H_
