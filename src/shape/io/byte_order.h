/* The byte order of this machine under VTK's name for it. */
#ifndef PEL_IO_BYTE_ORDER_H
#define PEL_IO_BYTE_ORDER_H

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
#define PEL_BYTE_ORDER_NAME "BigEndian"
#else
#define PEL_BYTE_ORDER_NAME "LittleEndian"
#endif

#endif
