/* SPDX-License-Identifier: MIT */
#include <winsock2.h>
#include <ws2tcpip.h>
#include <string.h>

#include "tools/grctl/os/net.h"

uint16_t net_port(evutil_socket_t fd)
{
    struct sockaddr_storage at;
    socklen_t size = sizeof at;
    memset(&at, 0, sizeof at);
    if (getsockname((SOCKET)fd, (struct sockaddr *)&at, &size) < 0) {
        return 0;
    }
    return ntohs(at.ss_family == AF_INET6 ? ((const struct sockaddr_in6 *)&at)->sin6_port
                                          : ((const struct sockaddr_in *)&at)->sin_port);
}

int net_is_loopback(const char *address)
{
    return strncmp(address, "127.", 4) == 0 || strcmp(address, "::1") == 0 ||
           strncmp(address, "::ffff:127.", 11) == 0;
}

void net_peer(evutil_socket_t fd, char *text, size_t capacity)
{
    struct sockaddr_storage from;
    socklen_t size = sizeof from;
    memset(&from, 0, sizeof from);
    *text = '\0';
    if (getpeername((SOCKET)fd, (struct sockaddr *)&from, &size) < 0) {
        return;
    }
    if (from.ss_family == AF_INET6) {
        inet_ntop(AF_INET6, &((const struct sockaddr_in6 *)&from)->sin6_addr, text, capacity);
    } else if (from.ss_family == AF_INET) {
        inet_ntop(AF_INET, &((const struct sockaddr_in *)&from)->sin_addr, text, capacity);
    }
    if (net_is_loopback(text)) {
        *text = '\0';
    }
}

void net_end(evutil_socket_t fd)
{
    (void)shutdown((SOCKET)fd, SD_BOTH);
}

void net_keep_little(evutil_socket_t fd, int bytes)
{
    (void)setsockopt((SOCKET)fd, SOL_SOCKET, SO_SNDBUF, (const char *)&bytes, sizeof bytes);
}
