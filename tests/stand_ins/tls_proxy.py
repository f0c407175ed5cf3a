"""Ends TLS and passes every byte on, as a proxy does that keeps the name that people asked for.

Arguments: certificate, key, the port for people, the port behind. Prints a line when it listens.
"""

import asyncio
import contextlib
import ssl
import sys


async def main(certificate: str, key: str, port: str, behind: str) -> None:
    tls = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    tls.load_cert_chain(certificate, key)

    async def pump(source: asyncio.StreamReader, sink: asyncio.StreamWriter) -> None:
        with contextlib.suppress(OSError):
            while data := await source.read(65536):
                sink.write(data)
                await sink.drain()
        sink.close()

    async def pass_on(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            source, sink = await asyncio.open_connection("127.0.0.1", int(behind))
        except OSError:
            writer.close()
            return
        await asyncio.gather(pump(reader, sink), pump(source, writer))

    async with await asyncio.start_server(pass_on, "127.0.0.1", int(port), ssl=tls) as server:
        sys.stdout.write("listening\n")
        sys.stdout.flush()
        await server.serve_forever()


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
