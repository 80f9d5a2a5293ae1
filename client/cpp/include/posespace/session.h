// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_H_
#define POSESPACE_SESSION_H_

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "posespace/error.h"
#include "posespace/options.h"
#include "posespace/player.h"
#include "posespace/results.h"

namespace posespace {

namespace internal {
class Answers;
class SessionHandle;
}  // namespace internal

// The frames of Session::Animate, one by one; ended early, the service stops making them.  One
// thread at a time; movable.
//
//   posespace::Animation animation = session.Animate(path);
//   while (std::optional<posespace::TimedFrame> frame = animation.Next()) Draw(frame->frame);
class Animation {
 public:
  Animation(Animation&&) noexcept;
  Animation& operator=(Animation&&) noexcept;
  ~Animation();

  // The next frame, or none after the last.  Throws Error as Session::Blend.
  std::optional<TimedFrame> Next();

 private:
  friend class Session;
  struct State;
  explicit Animation(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

// The pictures of Session::RenderAnimation, one by one; else as Animation.
class PictureStream {
 public:
  PictureStream(PictureStream&&) noexcept;
  PictureStream& operator=(PictureStream&&) noexcept;
  ~PictureStream();

  // The next picture, or none after the last.  Throws Error as Session::Render.
  std::optional<Picture> Next();

 private:
  friend class Session;
  struct State;
  explicit PictureStream(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

// A session of the service: drawings of one character, placed in a plane, and every drawing in
// between.  Made by Client.
//
//   posespace::Session session = client.CreateSession("tux");
//   session.PutShape("stand", posespace::ImageSource{posespace::ReadFile("stand.png")});
//   session.PutShape("jump", posespace::ImageSource{posespace::ReadFile("jump.png")});
//   session.SetPlacements({{"stand", {0, 0}}, {"jump", {0, 1}}});
//   session.Build();
//   posespace::Frame frame = session.Blend({0.0, 0.5});
//
// A handle, cheap to copy: what it stands for lives in the service, and other clients may change
// it. Use one from any number of threads.
//
// Every call waits for its answer, at most the client's timeout, and throws Error: kNotFound when
// the session is gone, kUnavailable, kDeadlineExceeded, and what it says below.
class Session {
 public:
  // The id it was made with, or that the service chose.
  const std::string& id() const;

  // Everything about the session as it stands.
  SessionState State() const;

  // The drawings in the order of upload, which is the order of weights.
  std::vector<std::string> ShapeIds() const;

  // Forgets the session, its drawings and its pose space; a running build is cancelled.  With
  // `etag`, only when the session still has it; else kConflict.
  void Delete(const std::string& etag = {});

  // Authoring.

  // Adds a drawing and answers how it was understood.  The source is sent, not copied, when moved
  // in. Throws kInvalidDrawing (the message says why no outline can be made of it), kAlreadyExists
  // when the id has another drawing and `replace` is not set, kResourceExhausted when it is too
  // large to send.  With `flip` its mirror image is kept, left and right exchanged about the middle
  // of the picture: what a person accepts of Suggest.
  posespace::Shape PutShape(const std::string& shape_id, ShapeSource source, bool replace = false,
                            bool flip = false);

  // A drawing's outline and warnings.  Throws kNotFound.
  posespace::Shape Shape(const std::string& shape_id) const;

  // All drawings, in the order of upload.
  std::vector<posespace::Shape> Shapes() const;

  // Removes a drawing, its marks and its placement.  Throws kNotFound.
  void DeleteShape(const std::string& shape_id);

  // Replaces all marked places; they take effect with the next build.  Each tuple marks one place
  // of the character in any of the drawings, in drawing pixels.
  //
  //   session.SetCorrespondences({{{"stand", {40, 12}}, {"jump", {52, 9}}}, ...});
  //
  // Throws kInvalidArgument with every fault in fields() (LANDMARK_OFF_OUTLINE,
  // LANDMARKS_OUT_OF_ORDER, ...), kNotFound, kConflict when `etag` is given and outdated.
  SessionState SetCorrespondences(const std::vector<std::map<std::string, Point>>& tuples,
                                  const std::string& etag = {});

  // What automatic matching would do with the drawings and marks as they are; nothing is changed.
  // `samples` places of the outline are answered, 1 to 1024; 64 by default.  Takes as long as a
  // build's matching, for which it waits a minute beyond the client's timeout.  `rotation` is as in
  // BuildOptions.
  // Throws kNotBuilt (NO_SHAPES) without drawings, kInvalidArgument when drawings or marks
  // contradict each other.
  Suggestion Suggest(std::optional<int> samples = {}, Rotation rotation = Rotation::kUpright) const;

  // Places every drawing in pose space; a built session follows at once, with a new revision.  None
  // at all returns to the default, the unit circle in the order of upload.
  // Throws kInvalidArgument (PLACEMENTS_COINCIDE, PLACEMENT_NOT_FINITE), kNotFound, kConflict when
  // `etag` is given and outdated.
  SessionState SetPlacements(const std::map<std::string, Point>& placements,
                             const std::string& etag = {});

  // Builds the pose space and waits until it is there.
  //
  // With the same inputs as a running or finished build it attaches to that one; else it starts
  // one, and waits for its place when too many builds are queued.  A stop, an exception in
  // on_progress and the timeout cancel a build that this call started, and only that.  A dropped
  // connection does not: watching goes on once the service answers again within the client's
  // timeout.
  //
  // Throws kNotBuilt (NO_SHAPES) without drawings, kInvalidArgument when drawings or marks
  // contradict each other, kCancelled when stopped, or when somebody cancels or replaces the build,
  // kResourceExhausted when the queue stays full for the timeout, kDeadlineExceeded after it.
  BuildReport Build(const BuildOptions& options = {});

  // Starts building as Build does and returns at once; State().build says how it goes.  It does not
  // wait, and passes over the options of waiting.
  BuildStatus StartBuild(const BuildOptions& options = {});

  // Stops the running build; without one it has no effect.
  void CancelBuild();

  // Reading what was built.  All throw kNotBuilt before the first build, and kInvalidArgument
  // (POSE_NOT_FINITE, WEIGHTS_SUM_NOT_ONE, INVALID_OPTION, ...).

  posespace::Mesh Mesh() const;

  // A drawing's pixels as a PNG file, straight alpha; Mesh().poses says where they lie.
  std::string TexturePng(const std::string& shape_id) const;

  // The drawing at a point of pose space, or at explicit weights; throws kNotFound for weights of
  // an unknown drawing.
  Frame Blend(Point at, const BlendOptions& options = {}) const;
  Frame Blend(const posespace::Weights& weights, const BlendOptions& options = {}) const;

  // The vertices at many points, all of one revision, also when there are too many for one message.
  // One bad point refuses the whole call, and fields() names it.
  FrameBatch BlendMany(std::span<const Point> points, const BlendOptions& options = {}) const;

  // The weights of the drawings at many points.
  WeightTable Weights(std::span<const Point> points) const;

  // A picture of the drawing there.
  Picture Render(Point at, const RenderOptions& options = {}) const;
  Picture Render(const posespace::Weights& weights, const RenderOptions& options = {}) const;

  // The drawings along a smooth path through the waypoints, all of one revision.  The service
  // begins with the first Next.  Throws there kInvalidArgument (PATH_INVALID, TOO_MANY_FRAMES,
  // ...).
  Animation Animate(std::span<const Waypoint> path, const AnimateOptions& options = {}) const;
  Animation Animate(std::span<const Point> path, const AnimateOptions& options = {}) const;

  // Pictures along such a path, at most 10,000; not paced.  The blend options are those of
  // `animation`.
  PictureStream RenderAnimation(std::span<const Waypoint> path,
                                const AnimateOptions& animation = {},
                                const RenderOptions& picture = {}) const;

  // Opens the stream that avatar servers live on, with this session bound to slot 0; see Player.
  // With `revision` it stays with that built pose space; else frames follow rebuilds.
  Player Play(const std::string& revision = {}) const;

 private:
  friend class Client;
  explicit Session(std::shared_ptr<internal::SessionHandle> handle) : handle_(std::move(handle)) {}

  std::shared_ptr<internal::SessionHandle> handle_;
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_H_
