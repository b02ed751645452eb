#!/usr/bin/env bash
# The include checker must find exactly the faults planted in bad_sample/, and fail.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")" || exit 1
found=$(bash check_includes.sh bad_sample)
status=$?
if [ $status -ne 1 ]; then
  echo "expected exit status 1, got $status"
  exit 1
fi
diff <(echo "$found") bad_sample/expected.txt && echo "found all $(wc -l <bad_sample/expected.txt) planted faults"
