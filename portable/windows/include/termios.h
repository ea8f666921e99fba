/* Windows: no terminals of this kind; libfyaml names them. */
#ifndef PEL_PORTABLE_WINDOWS_TERMIOS_H
#define PEL_PORTABLE_WINDOWS_TERMIOS_H
struct termios {
    int c_lflag;
};
#define TCSANOW 0
#define cfmakeraw(terminal) ((void)(terminal))
#define tcgetattr(descriptor, terminal) ((void)(terminal), -1)
#define tcsetattr(descriptor, when, terminal) ((void)(terminal), -1)
#endif
