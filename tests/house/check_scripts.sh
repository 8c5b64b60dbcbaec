#!/bin/bash
# Puts the scripts of tools/ through machines that this one is not: packages missing, no root, no sudo, another system,
# no network. dpkg-query, apt-get, id and sudo are stand-ins at the front of PATH. Run from the root of the project.
set -uo pipefail

place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
shims=$place/bin
state=$place/state # what the stand-ins remember
project=$place/project
mkdir -p "$shims" "$state" "$project"
cp -r tools "$project/"
mkdir "$project/bench" && cp bench/CMakeLists.txt "$project/bench/"
passed=0
failed=0

shim() {
  { printf '#!/bin/bash\n' && cat; } >"$shims/$1"
  chmod +x "$shims/$1"
}

# One machine: which packages it has, who runs, how sudo and apt-get behave, what system it is.
machine() {
  rm -rf "$shims" "$state"
  mkdir -p "$shims" "$state"
  printf '%s\n' "$1" | tr ' ' '\n' >"$state/installed"
  : >"$state/apt-calls"
  shim dpkg-query <<END
package=\${*: -1}
grep -qx -- "\$package" "$state/installed" && echo installed
END
  shim id <<<"echo ${2:-0}"
  shim apt-get <<END
echo "\$DEBIAN_FRONTEND \$*" >>"$state/apt-calls"
[[ " \$* " != *" install "* ]] || for word; do echo "\$word" >>"$state/installed"; done
END
  shim sudo <<'END'
while [[ $1 == -* ]]; do shift; done
exec "$@"
END
  printf 'ID=debian\nVERSION_ID="12"\nVERSION_CODENAME=bookworm\nPRETTY_NAME="Debian GNU/Linux 12"\n' >"$state/os-release"
}

run() {
  output=$(CI=true PATH="$shims:$PATH" COMPUEYE_OS_RELEASE="$state/os-release" COMPUEYE_RETRY_SECONDS=0 \
    "$project/tools/$1" "${@:2}" 2>&1 </dev/null)
  status=$?
}

# expect WHAT STATUS PATTERN: the last run's exit code, and a pattern its output matches ("" = no output at all).
expect() {
  local matched=no
  if [[ -z $3 ]]; then
    [[ -n $output ]] || matched=yes
  elif grep -qE -- "$3" <<<"$output"; then
    matched=yes
  fi
  if [[ $status -eq $2 && $matched == yes ]]; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    printf 'FAILED: %s: exit %s (expected %s), output (expected "%s"):\n%s\n' "$1" "$status" "$2" "$3" "$output"
  fi
}

calls() {
  output=$(grep -c "$1" "$state/apt-calls")
  status=0
}

everything=$(tools/install-packages --list build test lint | tr '\n' ' ')

machine "$everything"
run install-packages
expect "nothing missing says nothing" 0 ""
calls .
expect "nothing missing does not call apt-get" 0 '^0$'
run install-packages --check
expect "--check with nothing missing" 0 ""

machine "${everything/ninja-build /}"
run install-packages --check
expect "--check names what is missing" 1 '^ninja-build$'
calls .
expect "--check does not call apt-get" 0 '^0$'
run install-packages
expect "installs what is missing" 0 'installing 1 package.*ninja-build'
calls '^noninteractive .*-y.* install .*ninja-build$'
expect "one install, of that package only, without questions" 0 '^1$'
calls ' update$'
expect "one update" 0 '^1$'
run install-packages
expect "the second time there is nothing to do" 0 ""

machine "" 1000
run install-packages build
expect "through sudo" 0 'installing [12][0-9] package'

machine "" 1000
shim sudo <<<'exit 1'
run install-packages
expect "sudo that wants a password, nobody there" 1 'sudo wants a password'

machine "" 1000
rm "$shims/sudo"
mkdir "$state/path"
for tool in bash awk grep tr cat mkdir dirname env sleep tail mktemp; do
  ln -s "$(command -v "$tool")" "$state/path/$tool"
done
output=$(PATH="$shims:$state/path" COMPUEYE_OS_RELEASE="$state/os-release" "$project/tools/install-packages" 2>&1)
status=$?
expect "neither root nor sudo" 1 'neither root nor sudo'

machine ""
printf 'ID=fedora\nVERSION_ID=39\nPRETTY_NAME="Fedora 39"\n' >"$state/os-release"
run install-packages
expect "another system" 1 'this is Fedora 39, expected Debian 12 or newer'
machine ""
printf 'ID=debian\nVERSION_ID="11"\nVERSION_CODENAME=bullseye\nPRETTY_NAME="Debian 11"\n' >"$state/os-release"
run install-packages
expect "an older Debian" 1 'this is Debian 11, expected Debian 12 or newer'
machine ""
printf 'ID=raspbian\nVERSION_ID="12"\nVERSION_CODENAME=bookworm\nPRETTY_NAME="Raspbian 12"\n' >"$state/os-release"
run install-packages
expect "a derivative of Debian 12" 0 'installing'

machine ""
shim apt-get <<END
echo "\$*" >>"$state/apt-calls"
echo "Err:1 Temporary failure resolving 'somewhere'"
exit 100
END
run install-packages
expect "no network" 1 'cannot reach the package archive to install'
calls ' install '
expect "a second try, and no third" 0 '^2$'

machine ""
shim apt-get <<'END'
echo "E: dpkg was interrupted"
exit 100
END
run install-packages
expect "a broken package system" 1 'could not install .*log: '
expect "... whose words are shown" 1 'dpkg was interrupted'

machine ""
shim apt-get <<'END'
exit 0
END
run install-packages
expect "apt-get that claims success" 1 'still not installed'

machine "$everything"
run install-packages --check nonsense
expect "an unknown group" 2 "no package group 'nonsense'"
for script in check-package count-instructions foreign-root hil-kernel hil-kernel-root install-packages build-preset demo libgpiod2 mcu package test tidy; do
  run "$script" --help
  expect "$script --help has an example" 0 "^Example: tools/$script"
  run "$script" --nonsense
  expect "$script refuses an unknown option" 2 "unknown option '--nonsense'"
done

# The archives of another processor, asked for without a word to this machine's package system.
folder=$project/build/arm64-root
arm64_machine() {
  machine "$everything"
  rm -rf "$folder"
  shim apt-get <<END
echo "\$*" >>"$state/apt-calls"
for word; do [[ \$word != Dir::Cache=* ]] || touch "\${word#Dir::Cache=}/archives/libpng-dev_1_arm64.deb"; done
END
  shim dpkg-deb <<'END'
case $1 in
  --extract) mkdir -p "$3/usr/lib" && ln -s /lib/libm.so.6 "$3/usr/lib/libm.so" ;;
  --field) case ${3:-} in Package) echo libpng-dev ;; Multi-Arch) echo same ;; *) printf 'Package: libpng-dev\nDescription: x\n more\n' ;; esac ;;
  --fsys-tarfile) mkdir -p "$TMPDIR/usr/lib" && touch "$TMPDIR/usr/lib/libpng.a" && tar --create --directory "$TMPDIR" ./usr ;;
  --control) mkdir -p "$3" && echo 'libpng 16 libpng16-16' >"$3/shlibs" ;;
esac
END
}
export TMPDIR=$place
arm64_machine
run foreign-root
expect "a folder for arm64" 0 'build/arm64-root: 1 package'
output=$(readlink "$folder/usr/lib/libm.so")
expect "... whose links stay inside" 0 '^\.\./\.\./lib/libm\.so\.6$'
output=$(cat "$folder/var/lib/dpkg/info/libpng-dev:arm64."{list,shlibs})
expect "... and whose libraries dpkg-shlibdeps can ask about" 0 "^$folder/usr/lib/libpng.a"
calls 'Dir::State=.*APT::Architecture=arm64 .*--download-only install .*libusb-1.0-0-dev.* umockdev$'
expect "... with records of its own, and nothing installed" 0 '^1$'
calls ' install '
expect "... in one go" 0 '^1$'
run foreign-root
expect "the second time there is nothing to fetch" 0 ""
run foreign-root --renew
expect "--renew fetches again" 0 'build/arm64-root: 1 package'
arm64_machine
shim dpkg-deb <<<'exit 2'
run foreign-root
expect "a package that does not unpack" 1 'cannot unpack .*libpng-dev_1_arm64.deb'
run foreign-root
expect "... leaves no folder that would pass for whole" 1 'cannot unpack'
arm64_machine
shim apt-get <<'END'
echo "E: Unable to locate package umockdev"
exit 100
END
run foreign-root
expect "an archive without arm64" 1 'does not get these packages for arm64'
run foreign-root umockdev
expect "foreign-root takes no packages" 2 "unknown processor 'umockdev'"
run package toaster
expect "package refuses an unknown processor" 2 "unknown processor 'toaster'"
run check-package toaster
expect "check-package refuses an unknown processor" 2 "unknown processor 'toaster'"

# libgpiod 2 beside the installed one, from the archive that has the machine's own suite.
archive() {
  machine "$everything"
  rm -rf "$project/build/libgpiod2"
  printf 'Types: deb\nSuites: other\n\n# a word\n\nTypes: deb\nSuites: bookworm\nSigned-By: /keys/second.gpg\n' >"$state/two.sources"
  {
    printf 'suites=%q\n' "$1"
    cat <<END
echo "\$*" >>"$state/apt-calls"
[[ \$* != *indextargets* ]] || printf '%b' "\$suites"
for word; do [[ \$word != Dir::Etc::SourceList=* ]] || cat "\${word#*=}" >>"$state/sources"; done
[[ \$* != *download* ]] || touch libgpiod-dev_2_amd64.deb
END
  } | shim apt-get
  shim dpkg-deb <<'END'
mkdir -p "$3/usr/include" && touch "$3/usr/include/gpiod.h"
END
}
archive "other scheme:/one/ $state/two.sources:1\nbookworm scheme:/two/ $state/two.sources:2\n"
run libgpiod2
expect "a folder for libgpiod 2" 0 'build/libgpiod2/root: libgpiod-dev_2'
output=$(sort -u "$state/sources")
expect "... from the archive of the machine's suite, with its keys" 0 '^deb \[signed-by=/keys/second.gpg\] scheme:/two/ bookworm-backports main$'
calls 'Dir::State=.*Dir::Etc::SourceParts=/dev/null.* download libgpiod3 libgpiod-dev$'
expect "... with records of its own" 0 '^1$'
run libgpiod2
expect "the second time there is nothing to fetch" 0 ""
archive "other scheme:/one/ $state/two.sources:1\n"
run libgpiod2
expect "no archive of this suite" 1 'no archive in /etc/apt has the suite bookworm'
archive "bookworm scheme:/two/ $state/two.sources:2\n"
sed -i 's/^echo/[[ $* != *update* ]] || { echo "E: no Release file"; exit 100; }; echo/' "$shims/apt-get"
run libgpiod2
expect "an archive without backports" 1 'has libgpiod3 libgpiod-dev in bookworm-backports .*E: no Release file'
run libgpiod2
expect "... leaves no folder that would pass for whole" 1 'bookworm-backports'
archive "bookworm scheme:/two/ $state/two.sources:2\n"
sed -i 's/^echo/[[ $* != *update* ]] || { echo "Err:1 Temporary failure resolving"; exit 100; }; echo/' "$shims/apt-get"
run libgpiod2
expect "no network for libgpiod 2" 1 'cannot reach the package archive'
run test --preset fast
expect "test refuses an unknown preset" 2 "unknown preset 'fast'"
run test --filter
expect "test --filter wants a value" 2 'needs a value'
run count-instructions --target
expect "count-instructions --target wants a value" 2 'needs a value'
run count-instructions --target toaster
expect "count-instructions refuses an unknown target" 2 "unknown target 'toaster'"
run mcu M3
expect "mcu refuses an unknown core" 2 "unknown core 'M3'"
run mcu --case
expect "mcu --case wants a value" 2 'needs a value'
run bench --fast
expect "bench refuses an unknown option before a name" 2 "unknown option '--fast'"
run bench toaster
expect "bench refuses an unknown measurement and names those there are" 2 "unknown measurement 'toaster'.*frame"
run demo --out
expect "demo --out wants a folder" 2 'needs a folder'

printf '%s passed, %s failed\n' "$passed" "$failed"
[[ $failed -eq 0 && $passed -gt 0 ]]
