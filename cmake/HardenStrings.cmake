# cmake -DHEADER=… -P HardenStrings.cmake: lcm-gen 1.3.1 checks a string's length only against the end of the message.
# A negative one passes, and 0x80000000 makes decode() copy two gigabytes.
file(READ ${HEADER} code)
string(REGEX REPLACE "if\\((__[A-Za-z0-9_]*_len_?_?) > maxlen - pos\\)" "if(\\1 < 1 || \\1 > maxlen - pos)" code "${code}")
file(WRITE ${HEADER} "${code}")
