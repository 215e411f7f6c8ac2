#include "server/client/stream.h"

#include "server/client/stream_session.h"

namespace hermite::client {

Result<StreamOutcome> stream_frames(FrameSource& source, const StreamRequest& request,
                                    const StreamObserver& observer) {
  StreamSession session(source, request, observer);
  const Status status = session.run();
  session.close();
  if (!status.ok()) return status.error();
  return session.outcome();
}

Result<StreamOutcome> stream_sequence(const dataset::Sequence& sequence,
                                      const dataset::FrameRange& frames,
                                      const StreamRequest& request,
                                      const StreamObserver& observer) {
  RecordedFrames source(sequence, frames);
  return stream_frames(source, request, observer);
}

}  // namespace hermite::client
